#include "catalogue/device/body_patches.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

#include "core/errors.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Halves the free points until no part has more than `most`, and appends the ends of the parts.
void halve(const TissueBody& body, std::span<Index> points, std::size_t begin, std::size_t most,
           std::vector<std::size_t>& ends) {
  if (points.size() <= most) return ends.push_back(begin + points.size());
  const auto& X = body.mesh().points;
  Eigen::Vector3d low = X.col(points[0]), high = low;
  for (const Index p : points) low = low.cwiseMin(X.col(p)), high = high.cwiseMax(X.col(p));
  Eigen::Index along = 0;
  (high - low).maxCoeff(&along);
  const std::size_t parts = (points.size() + most - 1) / most, left = points.size() * (parts / 2) / parts;
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(left), points.end(),
                   [&](Index a, Index b) { return std::pair(X(along, a), a) < std::pair(X(along, b), b); });
  halve(body, points.first(left), begin, most, ends);
  halve(body, points.subspan(left), begin + left, most, ends);
}

/// One tetrahedron of the blocks: corners in the mesh.
struct Tetrahedra {
  std::span<const TetBlock> blocks;
  [[nodiscard]] std::size_t size() const { return blocks.size() * TetBlock::lanes; }
  [[nodiscard]] Index corner(std::size_t tet, std::size_t a) const {
    return blocks[tet / TetBlock::lanes].rows[a][tet % TetBlock::lanes] / 4;
  }
};

/// The tetrahedra at each point of the mesh in the order of their sums. Those of unused lanes have no forces.
std::vector<std::vector<std::int32_t>> tetrahedra_at(const Tetrahedra& all, std::size_t points) {
  std::vector<std::vector<std::int32_t>> at_point(points);
  for (std::size_t tet = 0; tet < all.size(); ++tet)
    if (all.blocks[tet / TetBlock::lanes].mu[tet % TetBlock::lanes] != 0)
      for (std::size_t a = 0; a < 4; ++a)
        at_point[at(all.corner(tet, a))].push_back(static_cast<std::int32_t>(tet));
  return at_point;
}

/// What steady loads add to each point of the mesh, in their order.
std::vector<std::vector<Eigen::Vector3d>> pushes_of(const TissueBody& body) {
  std::vector<std::vector<Eigen::Vector3d>> pushes(at(static_cast<Index>(body.mesh().point_count())));
  for (const PressingForce& load : body.settings().forces) {
    const Eigen::Vector3d force = load.profile.value(0) * load.force;
    for (std::size_t i = 0; i < load.points.size(); ++i)
      pushes[at(load.points[i])].push_back(load.shares[i] * force);
  }
  return pushes;
}

/// What one patch after the other is appended to.
class Cutter {
 public:
  Cutter(const TissueBody& body, std::vector<Index> points)
      : body_(body),
        points_(std::move(points)),
        tetrahedra_{body.green_blocks()},
        at_point_(tetrahedra_at(tetrahedra_, at(static_cast<Index>(body.mesh().point_count())))),
        pushes_(pushes_of(body)),
        number_(at_point_.size(), -1),
        local_(at_point_.size(), -1) {
    for (const Index p : points_) number_[at(p)] = count_++;
    for (std::size_t p = 0; p < number_.size(); ++p)
      if (number_[p] < 0) number_[p] = count_++;
  }

  void add(std::size_t begin, std::size_t end) {
    made_.begin.push_back(here(begin));
    const std::span<const Index> own(points_.data() + begin, end - begin);
    for (std::size_t p = 0; p < own.size(); ++p) local_[at(own[p])] = static_cast<std::int32_t>(p);
    const std::size_t slots = give_slots(own);
    std::vector<Index> used(own.begin(), own.end());
    for (const auto& [tet, slot] : slots_of_) add_tetrahedron(tet, slot, used);
    for (std::size_t p = own.size(); p < used.size(); ++p) made_.rim.push_back(number_[at(used[p])]);
    for (const Index p : used) local_[at(p)] = -1;
    made_.shared =
        std::max(made_.shared, static_cast<std::size_t>(shared_doubles(static_cast<std::int64_t>(used.size()),
                                                                       static_cast<std::int64_t>(slots))));
    fits_ = fits_ && slots < PatchCorners::nowhere && used.size() < PatchCorners::nowhere;
  }

  [[nodiscard]] bool fits() const { return fits_; }

  BodyPatches finish() {
    made_.begin.push_back(here(points_.size()));
    made_.points = count_;
    made_.gradients.resize(9 * tets_.size());
    for (std::size_t n = 0; n < tets_.size(); ++n) {
      const TetBlock& block = tetrahedra_.blocks[tets_[n] / TetBlock::lanes];
      const std::size_t lane = tets_[n] % TetBlock::lanes;
      for (std::size_t k = 0; k < 9; ++k) made_.gradients[k * tets_.size() + n] = block.gradients[k][lane];
      made_.half_lambda.push_back(block.half_lambda[lane]);
      made_.mu.push_back(block.mu[lane]);
    }
    made_.weight.resize(3 * points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const double mass = body_.point_mass()[points_[p]];
      made_.mass.push_back(mass);
      made_.drag.push_back(body_.settings().alpha * mass);
      const Eigen::Vector3d weight = body_.heavy_mass()[points_[p]] * body_.settings().gravity;
      for (std::size_t i = 0; i < 3; ++i)
        made_.weight[i * points_.size() + p] = weight[static_cast<Eigen::Index>(i)];
    }
    for (const Index p : body_.free_points()) made_.order.push_back(number_[at(p)]);
    // Displacements of at most a quarter of it differ by less than TissueBody::admits().
    const auto& X = body_.mesh().points;
    made_.watch = 2500 * (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).norm();
    return std::move(made_);
  }

 private:
  using Slots = std::array<std::uint16_t, 4>;

  [[nodiscard]] PatchBegin here(std::size_t own) const {
    return {static_cast<std::int32_t>(own), static_cast<std::int32_t>(made_.rim.size()),
            static_cast<std::int32_t>(tets_.size()), static_cast<std::int32_t>(made_.push_slot.size())};
  }

  /// Slots of the own points, one after the other: their tetrahedra, then their loads.
  std::size_t give_slots(std::span<const Index> own) {
    slots_of_.clear();
    std::size_t next = 0;
    for (const Index p : own) {
      for (const std::int32_t tet : at_point_[at(p)]) {
        auto& slots = slots_of_.try_emplace(tet, nowhere()).first->second;
        for (std::size_t a = 0; a < 4; ++a)
          if (tetrahedra_.corner(static_cast<std::size_t>(tet), a) == p)
            slots[a] = static_cast<std::uint16_t>(next);
        ++next;
      }
      for (const Eigen::Vector3d& push : pushes_[at(p)]) {
        made_.push_slot.push_back(static_cast<std::uint16_t>(next++));
        made_.push.insert(made_.push.end(), push.begin(), push.end());
      }
      made_.last_slot.push_back(static_cast<std::uint16_t>(next - 1));
    }
    return next;
  }

  void add_tetrahedron(std::int32_t tet, const Slots& slot, std::vector<Index>& used) {
    PatchCorners corners{};
    for (std::size_t a = 0; a < 4; ++a) {
      const Index p = tetrahedra_.corner(static_cast<std::size_t>(tet), a);
      std::int32_t& local = local_[at(p)];
      if (local < 0) {
        local = static_cast<std::int32_t>(used.size());
        used.push_back(p);
      }
      corners.point[a] = static_cast<std::uint16_t>(local);
      corners.slot[a] = slot[a];
    }
    made_.corners.push_back(corners);
    tets_.push_back(static_cast<std::size_t>(tet));
  }

  static constexpr Slots nowhere() {
    return {PatchCorners::nowhere, PatchCorners::nowhere, PatchCorners::nowhere, PatchCorners::nowhere};
  }

  const TissueBody& body_;
  std::vector<Index> points_;  ///< the free ones, patch by patch
  Tetrahedra tetrahedra_;
  std::vector<std::vector<std::int32_t>> at_point_;
  std::vector<std::vector<Eigen::Vector3d>> pushes_;
  std::vector<std::int32_t> number_, local_;  ///< of each point of the mesh: here, and in the patch
  std::map<std::int32_t, Slots> slots_of_;    ///< of the tetrahedra of a patch
  std::vector<std::size_t> tets_;
  std::int32_t count_ = 0;
  bool fits_ = true;
  BodyPatches made_;
};

}  // namespace

std::string unsuited_for_patches(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  if (body.green_blocks().empty()) return "has other elements than those of fem_green without fibres";
  if (settings.skin.kind != SkinSettings::Kind::none) return "has a skin";
  if (!settings.tools.empty()) return "meets a tool";
  if (!settings.elastic_supports.empty()) return "lies on springs";
  if (settings.beta != 0) return "has damping by its stiffness, beta";
  if (!body.is_autonomous()) return "has a load or a support that changes with time";
  for (const Support& support : settings.supports)
    if (!support.travel.isZero(0)) return "has a support that is moved";
  return {};
}

BodyPatches body_patches(const TissueBody& body, std::size_t points, std::size_t most_shared) {
  for (;; points = (points + 1) / 2) {
    std::vector<Index> order = body.free_points();
    std::vector<std::size_t> ends;
    halve(body, order, 0, points, ends);
    Cutter cutter(body, std::move(order));
    for (std::size_t begin = 0; const std::size_t end : ends) {
      cutter.add(begin, end);
      begin = end;
    }
    const bool fits = cutter.fits();
    BodyPatches patches = cutter.finish();
    if (fits && patches.shared <= most_shared) return patches;
    if (points == 1)
      throw InputError(
          "a point of the mesh has more tetrahedra than the device can add up; take a finer mesh");
  }
}

}  // namespace hmax
