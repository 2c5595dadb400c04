#include "catalogue/device/patches/body_patches.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/errors.hpp"
#include "problems/tissue/forces/fibres.hpp"
#include "problems/tissue/forces/nodal_pressure.hpp"
#include "problems/tissue/forces/quadratic_elements.hpp"
#include "problems/tissue/forces/tet_blocks.hpp"

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

/// The elements of a body in the order in which they are added up: lanes of blocks, or those of shared
/// pressures, or of ten nodes.
struct Tetrahedra {
  explicit Tetrahedra(const ElementParts& parts) {
    if (parts.tetrahedra) blocks = parts.tetrahedra->blocks();
    if (parts.of_pressures) of_pressures = parts.of_pressures->elements();
    if (parts.of_ten_nodes) of_ten_nodes = parts.of_ten_nodes->elements();
  }
  std::span<const TetBlock> blocks;
  std::span<const NodalPressure::Element> of_pressures;
  std::span<const QuadraticElements::Element> of_ten_nodes;

  [[nodiscard]] std::size_t size() const {
    return blocks.size() * TetBlock::lanes + of_pressures.size() + of_ten_nodes.size();
  }
  /// False of unused lanes, which have no forces.
  [[nodiscard]] bool is_used(std::size_t n) const {
    return blocks.empty() || blocks[n / TetBlock::lanes].mu[n % TetBlock::lanes] != 0;
  }
  /// Points of each.
  [[nodiscard]] std::size_t corners() const { return of_ten_nodes.empty() ? 4 : 10; }
  /// One of the mesh.
  [[nodiscard]] Index corner(std::size_t n, std::size_t a) const {
    if (!of_ten_nodes.empty()) return of_ten_nodes[n].points[a];
    if (!of_pressures.empty()) return of_pressures[n].points[a];
    return blocks[n / TetBlock::lanes].rows[a][n % TetBlock::lanes] / 4;
  }
  /// How many numbers BodyArrays::gradients has of each, and these, followed by half_lambda and mu.
  [[nodiscard]] std::size_t gradients() const { return of_ten_nodes.empty() ? 9 : 124; }
  [[nodiscard]] std::vector<double> numbers(std::size_t n) const {
    std::vector<double> all;
    if (!of_ten_nodes.empty()) {
      const QuadraticElements::Element& e = of_ten_nodes[n];
      for (int g = 0; g < 4; ++g)
        for (Eigen::Index k = 0; k < 30; ++k) all.push_back(e.gradient(g, k / 3, k % 3));
      for (int g = 0; g < 4; ++g) all.push_back(e.volume(g));
      all.insert(all.end(), {e.half_lambda(), e.mu()});
    } else if (!of_pressures.empty()) {
      const NodalPressure::Element& e = of_pressures[n];
      for (Eigen::Index k = 0; k < 9; ++k) all.push_back(e.rest.gradients(k / 3, k % 3));
      all.insert(all.end(), {e.rest.volume * e.own.lambda / 2, e.rest.volume * e.own.mu});
    } else {
      const TetBlock& block = blocks[n / TetBlock::lanes];
      const std::size_t lane = n % TetBlock::lanes;
      for (const auto& gradients_of : block.gradients) all.push_back(gradients_of[lane]);
      all.insert(all.end(), {block.half_lambda[lane], block.mu[lane]});
    }
    return all;
  }
};

/// The springs of a body, set after set.
struct Springs {
  std::vector<std::array<Index, 2>> points;  ///< the near and the far end of each
  std::vector<double> per_length, tension;   ///< as of BodyArrays
  std::vector<std::size_t> end;              ///< of each set
};

using Fibres = std::span<const FibreElements::Element>;

/// Their dampers, likewise.
struct Dampers {
  std::vector<std::array<Index, 2>> points;
  std::vector<double> damper;
};

/// A triangle of the surface and a tool that may touch it.
struct Contact {
  std::int32_t tool;
  const ToolContact::Triangle* triangle;
};

/// What is added up at a point of the mesh, in this order: tetrahedra, other parts, loads, tools.
struct Terms {
  enum Kind : std::size_t { fibre, spring, damper, triangle, contact, kinds };
  /// A force of part `number` of its kind, at its point `place`.
  struct Other {
    Kind kind;
    std::int32_t number;
    std::size_t place;
  };
  std::vector<std::int32_t> tetrahedra;
  std::vector<Other> others;
  std::vector<std::array<std::size_t, 2>> groups;  ///< of these: from where to where they are one sum
  std::vector<Other> contacts;
};

/// A set: what was added up at a point before the sum of the springs that begin there, these, and the rest.
void append_springs(const SpringSet::Sliced& set, std::vector<Terms>& terms, Springs& springs) {
  struct Ends {
    std::vector<std::int32_t> far_before, own, far_after;
  };
  std::vector<Ends> ends(terms.size());
  std::vector<bool> is_added(terms.size(), false);  // the sum of the springs that begin at a point
  for (const SpringSlice& slice : set.slices) {
    for (std::int32_t k = slice.begin; k < slice.end; ++k)
      for (std::size_t lane = 0; lane < SpringSlice::lanes; ++lane) {
        const SpringBlock& block = set.blocks[at(k)];
        if (block.tension[lane] == 0) continue;
        const Index near = slice.rows[lane] / 4, far = set.ends[at(k)].rows[lane] / 4;
        const auto spring = static_cast<std::int32_t>(springs.points.size());
        ends[at(near)].own.push_back(spring);
        (is_added[at(far)] ? ends[at(far)].far_after : ends[at(far)].far_before).push_back(spring);
        springs.points.push_back({near, far});
        springs.per_length.push_back(block.per_length[lane]);
        springs.tension.push_back(block.tension[lane]);
      }
    for (const Index row : slice.rows) is_added[at(row / 4)] = true;
  }
  for (std::size_t p = 0; p < terms.size(); ++p) {
    std::vector<Terms::Other>& others = terms[p].others;
    for (const std::int32_t spring : ends[p].far_before) others.push_back({Terms::spring, spring, 1});
    const std::size_t begin = others.size();
    for (const std::int32_t spring : ends[p].own) others.push_back({Terms::spring, spring, 0});
    if (others.size() > begin) terms[p].groups.push_back({begin, others.size()});
    for (const std::int32_t spring : ends[p].far_after) others.push_back({Terms::spring, spring, 1});
  }
}

/// Of another law: one after the other, without sums.
void append_springs(const SpringSet& set, std::vector<Terms>& terms, Springs& springs) {
  for (std::size_t i = 0; i < set.size(); ++i) {
    const SpringSet::Spring& each = set.spring(i);
    for (std::size_t a = 0; a < 2; ++a)
      terms[at(each.points[a])].others.push_back(
          {Terms::spring, static_cast<std::int32_t>(springs.points.size()), a});
    springs.points.push_back(each.points);
    springs.per_length.push_back(set.length(i));
    springs.tension.push_back(each.stiffness * set.length(i));
  }
}

void append_dampers(const SpringSet& set, std::vector<Terms>& terms, Dampers& dampers) {
  for (std::size_t i = 0; i < set.size(); ++i) {
    const SpringSet::Spring& each = set.spring(i);
    if (each.damper == 0) continue;
    for (std::size_t a = 0; a < 2; ++a)
      terms[at(each.points[a])].others.push_back(
          {Terms::damper, static_cast<std::int32_t>(dampers.points.size()), a});
    dampers.points.push_back(each.points);
    dampers.damper.push_back(each.damper);
  }
}

/// Those of unused lanes, which have no forces, are left out.
std::vector<Terms> terms_of(const TissueBody& body, const Tetrahedra& tetrahedra, Fibres fibres,
                            Springs& springs, Dampers& dampers) {
  std::vector<Terms> terms(at(static_cast<Index>(body.mesh().point_count())));
  for (std::size_t tet = 0; tet < tetrahedra.size(); ++tet)
    if (tetrahedra.is_used(tet))
      for (std::size_t a = 0; a < tetrahedra.corners(); ++a)
        terms[at(tetrahedra.corner(tet, a))].tetrahedra.push_back(static_cast<std::int32_t>(tet));
  for (std::size_t n = 0; n < fibres.size(); ++n)
    for (std::size_t a = 0; a < 4; ++a)
      terms[at(fibres[n].points[a])].others.push_back({Terms::fibre, static_cast<std::int32_t>(n), a});
  for (const SpringSet& set : body.spring_sets()) {
    if (const std::optional<SpringSet::Sliced> sliced = set.sliced())
      append_springs(*sliced, terms, springs);
    else
      append_springs(set, terms, springs);
    springs.end.push_back(springs.points.size());
    append_dampers(set, terms, dampers);
  }
  if (const Membrane* const skin = body.membrane())
    for (std::size_t n = 0; n < skin->size(); ++n)
      for (std::size_t a = 0; a < 3; ++a)
        terms[at(skin->points(n)[a])].others.push_back({Terms::triangle, static_cast<std::int32_t>(n), a});
  return terms;
}

/// Those of one tool after the other.
std::vector<Contact> append_contacts(const TissueBody& body, std::vector<Terms>& terms) {
  std::vector<Contact> contacts;
  for (std::int32_t tool = 0; const ToolContact& each : body.contacts()) {
    for (const ToolContact::Triangle& triangle : each.triangles()) {
      for (std::size_t a = 0; a < 3; ++a)
        terms[at(triangle.points[a])].contacts.push_back(
            {Terms::contact, static_cast<std::int32_t>(contacts.size()), a});
      contacts.push_back({tool, &triangle});
    }
    ++tool;
  }
  return contacts;
}

/// A load at one of its points.
struct Push {
  std::int32_t load;
  double share;
};

/// What loads add to each point of the mesh, in their order.
std::vector<std::vector<Push>> pushes_of(const TissueBody& body) {
  std::vector<std::vector<Push>> pushes(at(static_cast<Index>(body.mesh().point_count())));
  const std::vector<PressingForce>& loads = body.settings().forces;
  for (std::size_t n = 0; n < loads.size(); ++n)
    for (std::size_t i = 0; i < loads[n].points.size(); ++i)
      pushes[at(loads[n].points[i])].push_back({static_cast<std::int32_t>(n), loads[n].shares[i]});
  return pushes;
}

/// What one patch after the other is appended to.
class Cutter {
 public:
  Cutter(const TissueBody& body, std::vector<Index> points)
      : body_(body),
        points_(std::move(points)),
        parts_(body.element_parts()),
        tetrahedra_(parts_),
        fibres_{parts_.fibres ? parts_.fibres->fibres() : Fibres{}},
        terms_(terms_of(body, tetrahedra_, fibres_, springs_, dampers_)),
        contacts_(append_contacts(body, terms_)),
        pushes_(pushes_of(body)),
        number_(terms_.size(), -1),
        local_(terms_.size(), -1),
        place_(tetrahedra_.of_pressures.size(), -1),
        local_average_(parts_.of_pressures ? parts_.of_pressures->averages().size() : 0, -1) {
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
    for (const auto& [tet, slot] : of_tetrahedra_) add_tetrahedron(tet, slot, used);
    for (const auto& [fibre, slot] : of_others_[Terms::fibre])
      add_fibre(static_cast<std::size_t>(fibre), slot, used);
    add_springs(used);
    for (const auto& [damper, slot] : of_others_[Terms::damper]) {
      made_.damped.push_back(ends_of(dampers_.points[static_cast<std::size_t>(damper)], slot, used));
      made_.damper.push_back(dampers_.damper[static_cast<std::size_t>(damper)]);
    }
    for (const auto& [number, slot] : of_others_[Terms::triangle]) add_triangle(number, slot, used);
    for (const auto& [contact, slot] : of_others_[Terms::contact])
      add_contact(contacts_[static_cast<std::size_t>(contact)], slot, used);
    for (std::size_t p = own.size(); p < used.size(); ++p) made_.rim.push_back(number_[at(used[p])]);
    for (const Index p : used) local_[at(p)] = -1;
    const std::size_t averages = made_.average.size() - static_cast<std::size_t>(made_.begin.back().average);
    for (const std::int32_t average : std::span(made_.average).last(averages))
      local_average_[at(average)] = -1;
    made_.shared =
        std::max(made_.shared, static_cast<std::size_t>(shared_numbers(static_cast<std::int64_t>(used.size()),
                                                                       static_cast<std::int64_t>(slots),
                                                                       static_cast<std::int64_t>(averages))));
    fits_ = fits_ && std::max({slots, used.size(), averages}) < PatchCorners::nowhere;
  }

  [[nodiscard]] bool fits() const { return fits_; }

  BodyPatches finish() {
    made_.begin.push_back(here(points_.size()));
    made_.set_begin.push_back(static_cast<std::int32_t>(made_.ends.size()));
    made_.points = count_;
    if (parts_.of_pressures) place_pressures();
    place_numbers();
    if (parts_.fibres) place_fibres();
    made_.weight.resize(3 * points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const double mass = body_.point_mass()[points_[p]];
      made_.mass.push_back(mass);
      made_.drag.push_back(body_.settings().beta == 0 ? body_.settings().alpha * mass : 0.0);
      const Eigen::Vector3d weight = body_.heavy_mass()[points_[p]] * body_.settings().gravity;
      for (std::size_t i = 0; i < 3; ++i)
        made_.weight[i * points_.size() + p] = weight[static_cast<Eigen::Index>(i)];
    }
    for (const Index p : body_.free_points()) made_.order.push_back(number_[at(p)]);
    made_.number = number_;
    if (!springs_.end.empty() || body_.membrane() || !contacts_.empty()) place_rest();
    if (body_.membrane()) place_skin(*body_.membrane());
    place_supports();
    if (body_.settings().beta != 0) place_damping();
    // Displacements of at most a quarter of it differ by less than TissueBody::admits().
    const auto& X = body_.mesh().points;
    made_.watch = 2500 * (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).norm();
    return std::move(made_);
  }

 private:
  using Slots = std::array<std::uint16_t, 10>;

  void place_numbers() {
    if (parts_.tetrahedra) made_.law = parts_.tetrahedra->law();
    if (parts_.of_ten_nodes) made_.elements = PatchElements::of_ten_nodes;
    const std::size_t gradients = tetrahedra_.gradients();
    made_.gradients.resize(gradients * tets_.size());
    for (std::size_t n = 0; n < tets_.size(); ++n) {
      const std::vector<double> numbers = tetrahedra_.numbers(tets_[n]);
      for (std::size_t k = 0; k < gradients; ++k) made_.gradients[k * tets_.size() + n] = numbers[k];
      made_.half_lambda.push_back(numbers[gradients]);
      made_.mu.push_back(numbers[gradients + 1]);
    }
  }

  /// The columns of C = alpha M + beta K0, which are its rows, from those of the body.
  void place_damping() {
    const TissueBody::DofMatrix& C = body_.rayleigh();
    const auto free = static_cast<std::int32_t>(points_.size());
    std::vector<Eigen::Index> column(points_.size());  // of each point here, that of its x
    for (std::size_t p = 0; p < points_.size(); ++p)
      column[static_cast<std::size_t>(made_.order[p])] = 3 * static_cast<Eigen::Index>(p);
    std::array<std::vector<double>, 3> values;
    for (const Eigen::Index j : column) {
      for (Eigen::Index i = 0; i < 3; ++i)
        for (TissueBody::DofMatrix::InnerIterator entry(C, j + i); entry; ++entry) {
          values[static_cast<std::size_t>(i)].push_back(entry.value());
          const auto row = static_cast<std::int32_t>(entry.row());
          if (i == 0) made_.damped_by.push_back(row % 3 * free + made_.order[at(row / 3)]);
        }
      made_.damp_end.push_back(static_cast<std::int32_t>(made_.damped_by.size()));
    }
    for (const std::vector<double>& each : values)
      made_.damping.insert(made_.damping.end(), each.begin(), each.end());
  }

  void place_skin(const Membrane& skin) {
    made_.skin_modulus = skin.modulus(), made_.skin_poisson = skin.poisson();
    made_.skin_gradients.resize(4 * triangles_.size());
    for (std::size_t n = 0; n < triangles_.size(); ++n) {
      const Membrane::Triangle& triangle = skin.triangle(triangles_[n]);
      for (std::size_t k = 0; k < 4; ++k)
        made_.skin_gradients[k * triangles_.size() + n] = triangle.gradients[k];
      made_.skin_volume.push_back(triangle.volume);
    }
  }

  /// Springs that hold free points, supports that move, and what these drag.
  void place_supports() {
    const std::size_t free = points_.size();
    if (!body_.anchors().empty()) made_.anchor.resize(free);
    for (const TissueBody::Anchor& each : body_.anchors())
      made_.anchor[static_cast<std::size_t>(number_[at(each.point)])] = each.stiffness;
    made_.moved_by.assign(number_.size() - free, -1);
    const std::vector<Support>& supports = body_.settings().supports;
    std::size_t begin = 0;
    for (const std::size_t end : body_.support_ends()) {
      std::vector<Support> lot;
      for (std::size_t s = begin; s < end; ++s) lot.push_back({{}, supports[s].travel, supports[s].profile});
      const bool moves =
          !std::ranges::all_of(lot, [](const Support& support) { return support.travel.isZero(0); });
      for (const Index p : supports[begin].points)
        made_.moved_by[static_cast<std::size_t>(number_[at(p)]) - free] =
            moves ? static_cast<std::int32_t>(made_.motions.size()) : -1;
      if (moves) made_.motions.push_back(std::move(lot));
      begin = end;
    }
    for (std::size_t s = 0; s < supports.size(); ++s) {
      const TissueBody::Dofs& drag = body_.support_drag()[s];
      if (drag.isZero(0)) continue;
      made_.rates.push_back(supports[s].profile);
      const std::size_t first = made_.support_drag.size();
      made_.support_drag.resize(first + 3 * free);
      for (std::size_t n = 0; n < 3 * free; ++n)
        made_.support_drag[first + n % 3 * free + static_cast<std::size_t>(made_.order[n / 3])] =
            drag[static_cast<Eigen::Index>(n)];
    }
  }

  /// What comes before the patches: volumes of all tetrahedra, and the averages that they are added to.
  void place_pressures() {
    made_.elements = PatchElements::of_pressures;
    const std::span<const NodalPressure::Element> elements = tetrahedra_.of_pressures;
    std::vector<std::vector<std::int32_t>> among(local_average_.size());
    for (std::size_t tet = 0; tet < elements.size(); ++tet) {
      if (place_[tet] < 0) {  // of points that stand still, in no patch
        add_place(tet);
        made_.corners.emplace_back(), made_.averages.emplace_back();
      }
      BodyTetrahedron& own = made_.tetrahedra.emplace_back();
      own.place = place_[tet];
      for (std::size_t a = 0; a < 4; ++a) own.point[a] = number_[at(elements[tet].points[a])];
      for (const Index average : elements[tet].averages)
        among[at(average)].push_back(static_cast<std::int32_t>(tet));
    }
    for (const std::vector<std::int32_t>& own : among) {
      made_.among.insert(made_.among.end(), own.begin(), own.end());
      made_.average_ends.push_back(static_cast<std::int32_t>(made_.among.size()));
    }
    for (const std::size_t tet : tets_) made_.volume.push_back(elements[tet].rest.volume);
    for (const NodalPressure::Average& average : parts_.of_pressures->averages()) {
      made_.average_lambda.push_back(average.lambda);
      made_.average_volume.push_back(average.volume);
    }
  }

  void place_fibres() {
    made_.fibres_of_small_strain = parts_.fibres->is_of_small_strain();
    made_.fibre.resize(9 * cut_fibres_.size());
    for (std::size_t n = 0; n < cut_fibres_.size(); ++n) {
      const FibreElements::Element& e = fibres_[cut_fibres_[n]];
      const std::array numbers{e.slopes[0],    e.slopes[1],    e.slopes[2], e.slopes[3], e.direction[0],
                               e.direction[1], e.direction[2], e.young,     e.volume};
      for (std::size_t k = 0; k < numbers.size(); ++k) made_.fibre[k * cut_fibres_.size() + n] = numbers[k];
    }
  }

  void place_rest() {
    made_.rest.resize(3 * number_.size());
    for (std::size_t p = 0; p < number_.size(); ++p)
      for (std::size_t i = 0; i < 3; ++i)
        made_.rest[i * number_.size() + static_cast<std::size_t>(number_[p])] =
            body_.mesh().points(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(p));
  }

  [[nodiscard]] PatchBegin here(std::size_t own) const {
    return {static_cast<std::int32_t>(own),
            static_cast<std::int32_t>(made_.rim.size()),
            static_cast<std::int32_t>(tets_.size()),
            static_cast<std::int32_t>(made_.average.size()),
            static_cast<std::int32_t>(cut_fibres_.size()),
            static_cast<std::int32_t>(made_.push_slot.size()),
            static_cast<std::int32_t>(made_.damper.size()),
            static_cast<std::int32_t>(triangles_.size()),
            static_cast<std::int32_t>(made_.contacts.size())};
  }

  /// Slots of the own points, one after the other.
  std::size_t give_slots(std::span<const Index> own) {
    of_tetrahedra_.clear();
    for (auto& each : of_others_) each.clear();
    std::size_t next = 0;
    const auto give = [&](auto& slots_of, std::int32_t number, std::size_t place) {
      slots_of.try_emplace(number, nowhere()).first->second[place] = static_cast<std::uint16_t>(next++);
    };
    for (const Index p : own) {
      const Terms& terms = terms_[at(p)];
      for (const std::int32_t tet : terms.tetrahedra)
        for (std::size_t a = 0; a < tetrahedra_.corners(); ++a)
          if (tetrahedra_.corner(static_cast<std::size_t>(tet), a) == p) give(of_tetrahedra_, tet, a);
      for (const auto& [begin, end] : terms.groups)
        made_.groups.push_back(
            {static_cast<std::uint16_t>(next + begin), static_cast<std::uint16_t>(next + end)});
      for (const Terms::Other& other : terms.others) give(of_others_[other.kind], other.number, other.place);
      for (const Push& push : pushes_[at(p)]) {
        made_.push_slot.push_back(static_cast<std::uint16_t>(next++));
        made_.push_load.push_back(push.load);
        made_.push_share.push_back(push.share);
      }
      for (const Terms::Other& each : terms.contacts) give(of_others_[each.kind], each.number, each.place);
      made_.slots.push_back(
          {static_cast<std::int32_t>(made_.groups.size()), static_cast<std::uint16_t>(next)});
    }
    return next;
  }

  /// The number of a point in the patch, which it becomes a part of.
  std::uint16_t local(Index p, std::vector<Index>& used) {
    std::int32_t& number = local_[at(p)];
    if (number < 0) {
      number = static_cast<std::int32_t>(used.size());
      used.push_back(p);
    }
    return static_cast<std::uint16_t>(number);
  }

  void add_tetrahedron(std::int32_t tet, const Slots& slot, std::vector<Index>& used) {
    const auto place = [&](auto& corners) {
      for (std::size_t a = 0; a < tetrahedra_.corners(); ++a) {
        corners.point[a] = local(tetrahedra_.corner(static_cast<std::size_t>(tet), a), used);
        corners.slot[a] = slot[a];
      }
    };
    if (parts_.of_ten_nodes)
      place(made_.ten_nodes.emplace_back());
    else
      place(made_.corners.emplace_back());
    add_place(static_cast<std::size_t>(tet));
    if (!tetrahedra_.of_pressures.empty()) add_averages(tetrahedra_.of_pressures[tets_.back()]);
  }

  void add_place(std::size_t tet) {
    if (!place_.empty() && place_[tet] < 0) place_[tet] = static_cast<std::int32_t>(tets_.size());
    tets_.push_back(tet);
  }

  void add_averages(const NodalPressure::Element& element) {
    PatchAverages& averages = made_.averages.emplace_back();
    for (std::size_t a = 0; a < 4; ++a) {
      std::int32_t& number = local_average_[at(element.averages[a])];
      if (number < 0) {
        number = static_cast<std::int32_t>(made_.average.size()) - made_.begin.back().average;
        made_.average.push_back(element.averages[a]);
      }
      averages.of[a] = static_cast<std::uint16_t>(number);
    }
  }

  void add_fibre(std::size_t fibre, const Slots& slot, std::vector<Index>& used) {
    PatchCorners& corners = made_.fibre_corners.emplace_back();
    for (std::size_t a = 0; a < 4; ++a) {
      corners.point[a] = local(fibres_[fibre].points[a], used);
      corners.slot[a] = slot[a];
    }
    cut_fibres_.push_back(fibre);
  }

  /// Their numbers rise from set to set.
  void add_springs(std::vector<Index>& used) {
    const std::map<std::int32_t, Slots>& here = of_others_[Terms::spring];
    auto next = here.begin();
    for (const std::size_t end : springs_.end) {
      made_.set_begin.push_back(static_cast<std::int32_t>(made_.ends.size()));
      for (; next != here.end() && static_cast<std::size_t>(next->first) < end; ++next) {
        const auto spring = static_cast<std::size_t>(next->first);
        made_.ends.push_back(ends_of(springs_.points[spring], next->second, used));
        made_.per_length.push_back(springs_.per_length[spring]);
        made_.tension.push_back(springs_.tension[spring]);
      }
    }
  }

  PatchSpring ends_of(const std::array<Index, 2>& points, const Slots& slot, std::vector<Index>& used) {
    return {{local(points[0], used), local(points[1], used)}, {slot[0], slot[1]}};
  }

  void add_triangle(std::int32_t number, const Slots& slot, std::vector<Index>& used) {
    const auto n = static_cast<std::size_t>(number);
    made_.skin.push_back(corners_of(body_.membrane()->points(n), slot, used));
    triangles_.push_back(n);
  }

  void add_contact(const Contact& contact, const Slots& slot, std::vector<Index>& used) {
    made_.contacts.push_back(
        {corners_of(contact.triangle->points, slot, used), contact.tool, contact.triangle->samples});
  }

  PatchTriangle corners_of(const std::array<Index, 3>& points, const Slots& slot, std::vector<Index>& used) {
    return {{local(points[0], used), local(points[1], used), local(points[2], used)},
            {slot[0], slot[1], slot[2]}};
  }

  static Slots nowhere() {
    Slots slots;
    slots.fill(PatchCorners::nowhere);
    return slots;
  }

  const TissueBody& body_;
  std::vector<Index> points_;  ///< the free ones, patch by patch
  ElementParts parts_;
  Tetrahedra tetrahedra_;
  Fibres fibres_;
  Springs springs_;
  Dampers dampers_;
  std::vector<Terms> terms_;
  std::vector<Contact> contacts_;
  std::vector<std::vector<Push>> pushes_;
  std::vector<std::int32_t> number_, local_;     ///< of each point of the mesh: here, and in the patch
  std::vector<std::int32_t> place_;              ///< of tetrahedra of pressures: the first among `tets_`
  std::vector<std::int32_t> local_average_;      ///< in the patch
  std::map<std::int32_t, Slots> of_tetrahedra_;  ///< of a patch
  std::array<std::map<std::int32_t, Slots>, Terms::kinds> of_others_;  ///< likewise
  std::vector<std::size_t> tets_, cut_fibres_, triangles_;  ///< of all patches, one after the other
  std::int32_t count_ = 0;
  bool fits_ = true;
  BodyPatches made_;
};

}  // namespace

std::string unsuited_for_patches(const TissueBody& body) {
  const ElementParts parts = body.element_parts();
  if (!parts.tetrahedra && !parts.of_pressures && !parts.of_ten_nodes && body.element_pieces() > 0)
    return "has other elements than those of the models of hmax";
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
