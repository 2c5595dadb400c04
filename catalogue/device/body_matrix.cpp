#include "catalogue/device/body_matrix.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/fibres.hpp"
#include "problems/tissue/forces/nodal_pressure.hpp"
#include "problems/tissue/forces/quadratic_elements.hpp"
#include "problems/tissue/forces/rest_shape.hpp"
#include "problems/tissue/forces/tet_blocks.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;
using BlockTerms = std::vector<std::vector<std::int32_t>>;  ///< of each entry, in the order of their sum

MatrixArrays::Lists lists_of(const BlockTerms& terms) {
  MatrixArrays::Lists lists{{0}, {}};
  for (const std::vector<std::int32_t>& each : terms) {
    lists.of.insert(lists.of.end(), each.begin(), each.end());
    lists.first.push_back(static_cast<std::int32_t>(lists.of.size()));
  }
  return lists;
}

class MatrixMaker {
 public:
  MatrixMaker(const TissueBody& body, std::span<const std::int32_t> number)
      : body_(body), number_(number), free_(body.free_numbers()), made_(pattern_arrays(body)) {
    if (body.settings().beta != 0) made_.damping = made_.entries_of(body.rayleigh());
    made_.alpha = body.settings().alpha;
  }

  MatrixArrays finish() && {
    if (const TetBlocks* const tetrahedra = body_.element_parts().tetrahedra) {
      made_.law = tetrahedra->law();
      if (made_.law == TetLaw::green) make_pairs(tetrahedra->blocks());
      if (made_.law == TetLaw::small_strain) add_up_constant();
      if (made_.law == TetLaw::neo_hookean || made_.law == TetLaw::corotational) place_elements();
    }
    if (const NodalPressure* const elements = body_.element_parts().of_pressures) place_shared(*elements);
    if (const QuadraticElements* const elements = body_.element_parts().of_ten_nodes)
      place_ten_nodes(elements->elements());
    if (const FibreElements* const fibres = body_.element_parts().fibres) place_fibres(*fibres);
    if (!body_.spring_sets().empty()) place_springs();
    if (body_.membrane()) place_skin(*body_.membrane());
    if (!body_.contacts().empty()) place_contacts();
    return std::move(made_);
  }

 private:
  [[nodiscard]] std::size_t block(std::int32_t i, std::int32_t j) const { return made_.block(i, j); }

  /// The pairs of GreenElements: free points, then a free and a supported one in the order of both.
  void make_pairs(std::span<const TetBlock> blocks) {
    using RimPair = std::array<Index, 2>;
    std::vector<RimPair> on_rim;
    const auto each_pair = [&](const auto& visit) {
      std::int32_t tets = 0;
      for (const TetBlock& block : blocks) {
        std::array<std::int32_t, TetBlock::lanes> tet;
        for (std::size_t lane = 0; lane < TetBlock::lanes; ++lane)
          tet[lane] = block.mu[lane] != 0 ? tets++ : -1;  // unused lanes have no stiffness
        for (std::int32_t a = 0; a < 4; ++a)
          for (std::int32_t b = a + 1; b < 4; ++b)
            for (std::size_t lane = 0; lane < TetBlock::lanes; ++lane)
              if (tet[lane] >= 0)
                visit(block.rows[a][lane] / 4, block.rows[b][lane] / 4, 16 * tet[lane] + 4 * a + b);
      }
    };
    const auto rim_pair = [&](Index a, Index b) {
      return free_[at(a)] >= 0 ? RimPair{free_[at(a)], b} : RimPair{free_[at(b)], a};
    };
    const auto is_on_rim = [&](Index a, Index b) { return (free_[at(a)] < 0) != (free_[at(b)] < 0); };
    each_pair([&](Index a, Index b, std::int32_t) {
      if (is_on_rim(a, b)) on_rim.push_back(rim_pair(a, b));
    });
    sort_unique(on_rim);
    const std::int32_t inside = number_pairs();
    for (std::int32_t p = 0; p <= static_cast<std::int32_t>(body_.free_points().size()); ++p)
      made_.rim.push_back(inside + static_cast<std::int32_t>(std::ranges::lower_bound(on_rim, RimPair{p, 0}) -
                                                             on_rim.begin()));
    BlockTerms terms(at(inside) + on_rim.size());
    each_pair([&](Index a, Index b, std::int32_t term) {
      if (is_on_rim(a, b))
        terms[at(inside + (std::ranges::lower_bound(on_rim, rim_pair(a, b)) - on_rim.begin()))].push_back(
            term);
      else if (free_[at(a)] >= 0)
        terms[at(made_.sum_of[block(free_[at(b)], free_[at(a)])])].push_back(term);
    });
    made_.terms = lists_of(terms);
    place_tets(blocks);
  }

  /// Numbers of the pairs of free points. @returns how many there are
  std::int32_t number_pairs() {
    std::int32_t pairs = 0;
    made_.sum_of.assign(made_.blocks(), 0);
    for (std::size_t n = 0; n < made_.blocks(); ++n)
      if (made_.row[n] > made_.column[n]) {
        made_.sum_of[block(made_.column[n], made_.row[n])] = ~pairs;
        made_.sum_of[n] = pairs++;
      }
    return pairs;
  }

  void place_tets(std::span<const TetBlock> blocks) {
    for (const TetBlock& block : blocks)
      for (std::size_t lane = 0; lane < TetBlock::lanes; ++lane)
        if (block.mu[lane] != 0) {
          StiffTet& tet = made_.tets.emplace_back();
          for (std::size_t k = 0; k < 9; ++k) tet.gradients[k] = block.gradients[k][lane];
          tet.half_lambda = block.half_lambda[lane];
          tet.mu = block.mu[lane];
          for (std::size_t a = 0; a < 4; ++a) tet.corner[a] = number_[at(block.rows[a][lane] / 4)];
        }
  }

  /// Of small strain: the elements come before all else, also before their fibres.
  void add_up_constant() {
    made_.constant.assign(9 * made_.blocks(), 0.0);
    const auto add = [&](std::span<const Index> points, const Eigen::Ref<const Eigen::MatrixXd>& K) {
      for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = 0; b < points.size(); ++b) {
          const std::int32_t i = free_[at(points[a])], j = free_[at(points[b])];
          if (i < 0 || j < 0) continue;
          double* const to = made_.constant.data() + 9 * block(i, j);
          for (std::size_t k = 0; k < 9; ++k)
            to[k] += K(static_cast<Eigen::Index>(3 * a + k / 3), static_cast<Eigen::Index>(3 * b + k % 3));
        }
    };
    if (const FibreElements* const fibres = body_.element_parts().fibres)
      return fibres->matrix().visit_stiffness(NodeRows(at(body_.mesh().point_count())), add);
    std::size_t left = body_.element_pieces();
    body_.visit_rest_stiffness(
        [&](std::span<const Index> points, const Eigen::Ref<const Eigen::MatrixXd>& K) {
          if (left == 0) return;
          --left;
          add(points, K);
        });
  }

  /// Those of TetElements, in the order of the mesh.
  void place_elements() {
    const TetMesh& mesh = body_.mesh();
    BlockTerms terms(made_.blocks());
    for (Index t = 0; t < static_cast<Index>(mesh.tetrahedron_count()); ++t) {
      std::array<Index, 4> points;
      for (std::size_t a = 0; a < 4; ++a) points[a] = mesh.tetrahedra(static_cast<Eigen::Index>(a), t);
      append_pairs(points, t, terms);
      const RestShape rest(mesh, points);
      const TissueMaterial& material = body_.settings().materials[at(mesh.region(t))];
      const Lame moduli = lame(material.young, material.poisson);
      made_.tets.push_back(stiff_tet(points, rest, moduli));
    }
    made_.terms = lists_of(terms);
  }

  [[nodiscard]] StiffTet stiff_tet(const std::array<Index, 4>& points, const RestShape& rest,
                                   const Lame& moduli) const {
    StiffTet tet;
    tet.half_lambda = rest.volume * moduli.lambda / 2;
    tet.mu = rest.volume * moduli.mu;
    for (std::size_t k = 0; k < 9; ++k)
      tet.gradients[k] = rest.gradients(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3));
    for (std::size_t a = 0; a < 4; ++a) tet.corner[a] = number_[at(points[a])];
    return tet;
  }

  void place_shared(const NodalPressure& pressures) {
    made_.law = TetLaw::neo_hookean;
    made_.averages = static_cast<std::int32_t>(pressures.averages().size());
    BlockTerms terms(made_.blocks());
    struct Term {
      std::int32_t point, average, of;  // of a gradient: 4 times the element + its corner
      auto operator<=>(const Term&) const = default;
    };
    std::vector<Term> of_gradients;
    for (const NodalPressure::Element& e : pressures.elements()) {
      const auto number = static_cast<std::int32_t>(made_.tets.size());
      append_pairs(e.points, number, terms);
      made_.tets.push_back(stiff_tet(e.points, e.rest, e.own));
      std::ranges::copy(e.averages, made_.shares.emplace_back(StiffShares{e.rest.volume, {}}).average);
      for (std::int32_t b = 0; b < 4; ++b)
        if (const std::int32_t point = free_[at(e.points[at(b)])]; point >= 0)
          for (const Index average : e.averages) of_gradients.push_back({point, average, 4 * number + b});
    }
    made_.terms = lists_of(terms);
    std::ranges::sort(of_gradients);
    BlockTerms at_point(body_.free_points().size()), of_average;
    for (std::size_t n = 0; n < of_gradients.size(); ++n) {
      const auto& [point, average, of] = of_gradients[n];
      std::vector<std::int32_t>& around = at_point[at(point)];
      if (around.empty() || around.back() != average) {
        around.push_back(average);
        of_average.emplace_back();
      }
      of_average.back().push_back(of);
    }
    made_.averages_at_point = lists_of(at_point);
    made_.gradient_terms = lists_of(of_average);
  }

  void place_ten_nodes(std::span<const QuadraticElements::Element> elements) {
    made_.law = TetLaw::neo_hookean;
    BlockTerms terms(made_.blocks());
    for (const QuadraticElements::Element& e : elements) {
      const auto number = static_cast<std::int32_t>(made_.ten_nodes.size());
      StiffTenNodes& to = made_.ten_nodes.emplace_back();
      for (std::int32_t a = 0; a < 10; ++a) {
        to.point[a] = number_[at(e.points[at(a)])];
        for (int g = 0; g < 4; ++g)
          for (int j = 0; j < 3; ++j) to.gradients[g][a][j] = e.gradient(g, a, j);
        for (std::int32_t b = 0; b < 10; ++b)
          if (const std::int32_t i = free_[at(e.points[at(a)])], j = free_[at(e.points[at(b)])];
              i >= 0 && j >= 0)
            terms[block(i, j)].push_back(100 * number + 10 * a + b);
      }
      for (int g = 0; g < 4; ++g) to.volumes[g] = e.volume(g);
      to.moduli[0] = e.half_lambda(), to.moduli[1] = e.mu();
    }
    made_.terms = lists_of(terms);
  }

  /// Appends 16 times the element + 4 a + b to the blocks of its corners a and b.
  void append_pairs(const std::array<Index, 4>& points, std::int32_t element, BlockTerms& terms) const {
    for (std::int32_t a = 0; a < 4; ++a)
      for (std::int32_t b = 0; b < 4; ++b)
        if (const std::int32_t i = free_[at(points[at(a)])], j = free_[at(points[at(b)])]; i >= 0 && j >= 0)
          terms[block(i, j)].push_back(16 * element + 4 * a + b);
  }

  void place_fibres(const FibreElements& fibres) {
    BlockTerms terms(made_.blocks());
    for (const FibreElements::Element& from : fibres.fibres()) {
      append_pairs(from.points, static_cast<std::int32_t>(made_.fibres.size()), terms);
      StiffFibre& to = made_.fibres.emplace_back();
      std::ranges::copy(from.slopes, to.slopes);
      std::ranges::copy(from.direction, to.direction);
      to.young = from.young;
      to.volume = from.volume;
      for (std::size_t a = 0; a < 4; ++a) to.corner[a] = number_[at(from.points[a])];
    }
    made_.fibre_terms = lists_of(terms);
  }

  void place_springs() {
    BlockTerms terms(made_.blocks()), damped(made_.blocks());
    for (std::int32_t number = 0; const SpringSet& set : body_.spring_sets()) {
      for (std::size_t n = 0; n < set.size(); ++n) {
        const auto& [points, stiffness, damper] = set.spring(n);
        const auto append = [&](BlockTerms& to, std::size_t term) {
          for (const Index a : points)
            for (const Index b : points)
              if (free_[at(a)] >= 0 && free_[at(b)] >= 0)
                to[block(free_[at(a)], free_[at(b)])].push_back(static_cast<std::int32_t>(term));
        };
        append(terms, made_.springs.size());
        const std::int32_t ends[2] = {number_[at(points[0])], number_[at(points[1])]};
        made_.springs.push_back({stiffness, set.length(n), {ends[0], ends[1]}, number});
        if (damper == 0) continue;
        append(damped, made_.dampers.size());
        made_.dampers.push_back({damper, {ends[0], ends[1]}});
      }
      ++number;
    }
    made_.spring_terms = lists_of(terms);
    made_.damper_terms = lists_of(damped);
  }

  void place_skin(const Membrane& skin) {
    BlockTerms terms(made_.blocks());
    for (std::size_t n = 0; n < skin.size(); ++n) {
      const Membrane::Triangle& from = skin.triangle(n);
      StiffTriangle& to = made_.triangles.emplace_back();
      std::ranges::copy(from.gradients, to.gradients);
      to.volume = from.volume;
      append_triangle(from.points, static_cast<std::int32_t>(n), to.corner, terms);
    }
    made_.triangle_terms = lists_of(terms);
  }

  void place_contacts() {
    BlockTerms terms(made_.blocks());
    for (std::int32_t tool = 0; const ToolContact& each : body_.contacts()) {
      for (const ToolContact::Triangle& from : each.triangles()) {
        const auto number = static_cast<std::int32_t>(made_.contacts.size());
        StiffContact& to = made_.contacts.emplace_back();
        to.tool = tool;
        to.samples = from.samples;
        append_triangle(from.points, number, to.corner, terms);
      }
      ++tool;
    }
    made_.contact_terms = lists_of(terms);
  }

  /// Appends 9 times the triangle + 3 a + b to the blocks of its corners a and b.
  void append_triangle(const std::array<Index, 3>& points, std::int32_t triangle, std::int32_t* corner,
                       BlockTerms& terms) const {
    for (std::int32_t a = 0; a < 3; ++a) {
      corner[a] = number_[at(points[at(a)])];
      for (std::int32_t b = 0; b < 3; ++b)
        if (const std::int32_t i = free_[at(points[at(a)])], j = free_[at(points[at(b)])]; i >= 0 && j >= 0)
          terms[block(i, j)].push_back(9 * triangle + 3 * a + b);
    }
  }

  const TissueBody& body_;
  std::span<const std::int32_t> number_;
  const std::vector<std::int32_t>&
      free_;  ///< of each point of the mesh: its number among the free ones, or -1
  MatrixArrays made_;
};

}  // namespace

std::size_t MatrixArrays::block(std::int32_t i, std::int32_t j) const {
  const auto from = column.begin() + first[at(i)], to = column.begin() + first[at(i) + 1];
  return static_cast<std::size_t>(std::lower_bound(from, to, j) - column.begin());
}

std::vector<double> MatrixArrays::entries_of(const TissueBody::DofMatrix& matrix) const {
  std::vector<double> entries(9 * blocks());
  for (Eigen::Index j = 0; j < matrix.cols(); ++j)
    for (TissueBody::DofMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      const std::size_t number =
          block(static_cast<std::int32_t>(entry.row() / 3), static_cast<std::int32_t>(j / 3));
      entries[9 * number + at(3 * (entry.row() % 3) + j % 3)] = entry.value();
    }
  return entries;
}

MatrixArrays pattern_arrays(const TissueBody& body) {
  // That of damping is the one of the stiffness; rows of blocks are columns, as it is symmetric.
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix C;
  body.damping(0, still, still, C);
  MatrixArrays made;
  made.first.push_back(0);
  for (std::int32_t j = 0; j < static_cast<std::int32_t>(C.cols() / 3); ++j) {
    for (TissueBody::DofMatrix::InnerIterator entry(C, Eigen::Index{3} * j); entry; ++entry)
      if (entry.row() % 3 == 0) {
        made.row.push_back(j);
        made.column.push_back(static_cast<std::int32_t>(entry.row() / 3));
      }
    made.first.push_back(static_cast<std::int32_t>(made.column.size()));
  }
  return made;
}

MatrixArrays matrix_arrays(const TissueBody& body, std::span<const std::int32_t> number) {
  return MatrixMaker(body, number).finish();
}

namespace {

TermLists there_of(DeviceMemory& memory, const MatrixArrays::Lists& from) {
  return {memory.copy(from.first), memory.copy(from.of)};
}

StiffPressures pressures_of(DeviceMemory& memory, const MatrixArrays& made) {
  if (made.shares.empty()) return {};
  const std::size_t gradients = made.averages_at_point.of.size();
  return {.averages = made.averages,
          .gradients = static_cast<std::int32_t>(gradients),
          .tets = memory.copy(made.shares),
          .at_point = there_of(memory, made.averages_at_point),
          .terms = there_of(memory, made.gradient_terms),
          .gradient = memory.room<double>(3 * gradients),
          .pressure = memory.room<double>(at(made.averages))};
}

}  // namespace

MatrixOnDevice::MatrixOnDevice(DeviceMemory& memory, const MatrixArrays& made, const BodyPatches& patches) {
  const auto count = [](const MatrixArrays::Lists& of) { return static_cast<double>(of.of.size()); };
  terms_ = count(made.terms) + count(made.fibre_terms) + count(made.spring_terms) + count(made.damper_terms) +
           count(made.triangle_terms) + count(made.contact_terms) + count(made.gradient_terms) +
           count(made.averages_at_point);
  // Of tools: the look at the box around each triangle, as of forces.
  flops_of_terms_ = (made.ten_nodes.empty() ? 260 : 1640) * count(made.terms) +
                    113 * count(made.fibre_terms) + 60 * count(made.spring_terms) +
                    135 * count(made.damper_terms) + 390 * count(made.triangle_terms) +
                    18 * count(made.contact_terms) + 130 * count(made.gradient_terms);
  std::vector<double> around(at(made.averages));  // how many gradients an average has
  for (const std::int32_t average : made.averages_at_point.of) ++around[at(average)];
  for (const double each : around) flops_of_terms_ += 18 * each * each;
  const auto lists = [&](const MatrixArrays::Lists& from) { return there_of(memory, from); };
  there_ = {.points = patches.free(),
            .blocks = static_cast<std::int32_t>(made.blocks()),
            .sums = static_cast<std::int32_t>(made.sums()),
            .first = memory.copy(made.first),
            .row = memory.copy(made.row),
            .column = memory.copy(made.column),
            .law = made.law,
            .tets = memory.copy(made.tets),
            .ten_nodes = made.ten_nodes.empty() ? nullptr : memory.copy(made.ten_nodes),
            .sum = nullptr,
            .terms = lists(made.terms),
            .sum_of = memory.copy(made.sum_of),
            .rim = memory.copy(made.rim),
            .pressures = pressures_of(memory, made),
            .fibres = made.fibres.empty() ? nullptr : memory.copy(made.fibres),
            .fibre_terms = lists(made.fibre_terms),
            .springs = made.springs.empty() ? nullptr : memory.copy(made.springs),
            .spring_terms = lists(made.spring_terms),
            .triangles = made.triangles.empty() ? nullptr : memory.copy(made.triangles),
            .triangle_terms = lists(made.triangle_terms),
            .dampers = made.dampers.empty() ? nullptr : memory.copy(made.dampers),
            .damper_terms = lists(made.damper_terms),
            .contacts = {memory.copy(made.contacts), lists(made.contact_terms)},
            .damping = made.damping.empty() ? nullptr : memory.copy(made.damping),
            .alpha = made.alpha,
            .values = memory.room<double>(9 * made.blocks()),
            .diagonal = nullptr,
            .place = memory.copy(patches.order)};
  if (const std::size_t numbers = std::max(9 * made.sums(), made.constant.size()); numbers > 0)
    there_.sum = memory.room<double>(numbers);
  if (!made.constant.empty())
    memory.device().write(there_.sum, made.constant.data(), sizeof(double) * made.constant.size());
  there_.diagonal = memory.room<double>(static_cast<std::size_t>(there_.dofs()));
}

void MatrixOnDevice::append(double h, const BodyStep<double>& step,
                            std::vector<DeviceProgram>& programs) const {
  const TetStiffness tets{there_, step.q_next, step.body.points};
  if (there_.pressures.tets) programs.push_back({PressureGradients{tets, step.body.pressures}});
  if (there_.sums > 0) programs.push_back({tets});
  programs.push_back({MatrixBlocks{there_, h, step, step.evaluation}});
}

double MatrixOnDevice::flops() const { return flops_of_terms_ + 20.0 * there_.blocks; }

double MatrixOnDevice::bytes() const {
  constexpr double number = sizeof(double), place = sizeof(std::int32_t);
  const double constant =
      (there_.sum && there_.sums == 0 ? 9 * number : 0) + (there_.damping ? 9 * number : 0);
  return place * terms_ + 2 * 3 * number * there_.pressures.gradients + 2 * 9 * number * there_.sums +
         (9 * number + constant + 3 * place) * there_.blocks;
}

}  // namespace hmax
