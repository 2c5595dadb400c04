#include "catalogue/models/idle_parameters.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// Whether Young's modulus of the regions reaches anything but the springs on the edges: the default
/// stiffness of a tool.
bool tool_takes_young(const TissueId& id, const TissueParameters& p) {
  return id.load == "tool" && p.tool_stiffness == 0;
}

bool has_fibres(const TissueParameters& p) {
  return p.fibre_E != 0 || std::ranges::any_of(p.of_regions, [](const TissueParameters::OfRegion& set) {
           return set.what == &TissueMaterial::fibre_young && set.value != 0;
         });
}

bool holds_share(const TissueParameters& p) { return p.support > 0 && !p.has_box() && p.supports.empty(); }

std::string why_young(const TissueId& id, const TissueParameters& p, std::string_view name) {
  const bool of_skin = name == "E" && p.skin != 0;
  if (!id.is_of_springs() || p.k == 0 || of_skin || tool_takes_young(id, p)) return {};
  return fmt::format(
      "{} does not act where k = {} N/m gives the stiffness of every spring; leave one of them out", name,
      to_text(p.k));
}

std::string why_density(const TissueParameters& p, std::string_view name) {
  // Beside a mass densities could only be ratios, which nobody reads in kg/m^3.
  if (p.mass == 0) return {};
  return fmt::format(
      "{} does not act where mass or a material gives the mass of the body, {} kg; leave it out, or set mass=0 and "
      "the density of every region",
      name, to_text(p.mass));
}

/// The axis says which end is held, and from where loads come.
std::string why_axis(const TissueId& id, const TissueParameters& p) {
  const bool directed = p.tool_dx != 0 || p.tool_dy != 0 || p.tool_dz != 0;
  if (holds_share(p) || !(id.load == "gravity" || (id.load == "tool" && directed))) return {};
  return "axis does not act where no end of the body is held; leave it out or give support a share";
}

}  // namespace

bool is_read(std::string_view readers, const TissueId& id) {
  if (readers.empty() || readers == only_springs) return readers.empty() || id.is_of_springs();
  if (readers == only_elements) return !id.is_of_springs();
  return fmt::format(" {} ", readers).find(fmt::format(" {} ", id.load)) != std::string::npos;
}

void require_read(std::string_view parameter, std::string_view readers, const TissueId& id) {
  if (is_read(readers, id)) return;
  if (readers == only_springs)
    throw input_error("{} is of springs, and {} has none; leave it out or take {}", parameter, id.model,
                      std::ranges::find_if(tissue_models(), &TissueModel::is_of_springs)->id);
  if (readers == only_elements)
    throw input_error("{} is of finite elements, and {} has none; leave it out or take {}", parameter,
                      id.model, tissue_models().front().id);
  const std::string_view first = readers.substr(0, readers.find(' '));
  throw input_error("{} is not of the load {}; leave it out or take --load {}", parameter, id.load, first);
}

std::string why_idle(const TissueId& id, const TissueParameters& p, std::string_view name) {
  const std::string_view what = name.substr(0, name.find(':'));
  if (what == "nu" && id.is_of_springs())
    return fmt::format("{} does not act on {}, whose springs have a Poisson's ratio of 1/4; leave it out",
                       name, id.model);
  if (what == "E" || what == "inclusion") return why_young(id, p, name);
  if ((what == "fibre_x" || what == "fibre_y" || what == "fibre_z") && !has_fibres(p))
    return fmt::format("{} does not act where there are no fibres; give fibre_E, or leave it out", name);
  if (what == "rho") return why_density(p, name);
  if (name == "support" && p.has_box())
    return "support does not act beside a box from xmin, ymin, zmin to xmax, ymax, zmax; leave one of them out";
  if (name == "support" && !p.supports.empty())
    return "support does not act beside sets of points that are held; leave it out";
  if (name == "axis") return why_axis(id, p);
  return {};
}

}  // namespace hmax
