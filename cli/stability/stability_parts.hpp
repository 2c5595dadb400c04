/// Regions of methods that are told more of a mode than z = h lambda: what of it is stiff, or what an old
/// Jacobian says in its place.
#pragma once

#include "cli/shared/options.hpp"
#include "cli/stability/stability_pictures.hpp"

namespace CLI {
class App;
}

namespace hmax {

/// --fast and --ratios of `hmax stability region`
struct PartsChoice {
  std::string
      fast{};  ///< of implicit-explicit methods: z of the stiff part, real or imaginary, "0,-1,-10,5i"
  std::string ratios{};  ///< of linearly implicit methods: lambda over what the Jacobian says it is

  void add_to(CLI::App& command);
  [[nodiscard]] bool any() const { return !fast.empty() || !ratios.empty(); }
};

/// A method beside one such number: the id says both, the amplification is that of the plane that is drawn.
struct PartRegion {
  Formula formula;
  Complex fast = 0;
  double ratio = 1;
};

/// The regions of one method for each of the numbers.
/// @throws InputError  unless the method is one that is told so
std::vector<PartRegion> part_regions(const Formula& formula, const PartsChoice& parts);

/// A window that shows all of them.
PlaneWindow window_of(const std::vector<PartRegion>& regions, const PlaneLook& look);

/// Of an implicit-explicit method the outlines of its regions in the z of what is not stiff, and how far it
/// may swing beside a decay of any size; of a linearly implicit one a panel for each ratio.
NamedFigure picture_of(const Formula& formula, const std::vector<PartRegion>& regions, const PlaneLook& look);

/// The panels of that picture for a page: two columns.
std::vector<Panel> panels_of(const Formula& formula, const std::vector<PartRegion>& regions,
                             const PlaneLook& look, int height);

}  // namespace hmax
