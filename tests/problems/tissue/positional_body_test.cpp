/// Bodies point by point and by their constraints: the same forces as the body as a whole.
#include "problems/tissue/positional_body.hpp"

#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using namespace tissue_tests;

/// Settings that methods take point by point: loads, supports that stand still, springs as supports, Rayleigh
/// damping.
std::vector<NamedSettings> pointwise_settings() {
  std::vector<NamedSettings> all;
  for (NamedSettings& named : loaded_settings()) {
    named.settings.tools.clear();
    named.settings.supports.front().travel.setZero();
    named.settings.springs.damper = named.settings.springs.damper_time = 0;
    const TissueBody body(uneven_box_for(named.settings.model), named.settings);
    if (PositionalBody::why_not(body, PositionalVerbs::points).empty()) all.push_back(std::move(named));
  }
  return all;
}

std::shared_ptr<const TissueBody> make_body(const TissueSettings& settings) {
  return std::make_shared<const TissueBody>(uneven_box_for(settings.model), settings);
}

TEST(PositionalBody, HasTheForcesOfTheBodyPointByPoint) {
  const std::vector<NamedSettings> all = pointwise_settings();
  ASSERT_GE(all.size(), 9u);  // four laws of elements, four of springs, and all sets of them
  for (const NamedSettings& named : all)
    for (const double beta : {0.0, 0.02}) {
      TissueSettings settings = named.settings;
      settings.beta = beta;
      const auto body = make_body(settings);
      const PositionalBody points(body, PositionalVerbs::points);
      const Eigen::VectorXd q = random_vector(body->dofs(), 4e-3, 1), v = random_vector(body->dofs(), 0.1, 2);
      const double t = 0.37;
      const Eigen::VectorXd f = force(*body, t, q, v);
      const Eigen::MatrixXd K = stiffness(*body, t, q, v), C = damping(*body, t, q, v);
      for (Eigen::Index i = 0; i < body->dofs() / 3; ++i) {
        PointForce at;
        points.point_force(t, q, v, static_cast<std::int32_t>(i), at);
        EXPECT_LT((at.f - f.segment<3>(3 * i)).norm(), 1e-10 * f.norm()) << named.name << ", point " << i;
        const Eigen::Matrix3d block = K.block<3, 3>(3 * i, 3 * i), damped = C.block<3, 3>(3 * i, 3 * i);
        EXPECT_LT((at.K - block).norm(), 1e-10 * block.norm()) << named.name << ", point " << i;
        EXPECT_LT((at.C - damped).norm(), 1e-10 * damped.norm()) << named.name << ", point " << i;
      }
    }
}

TEST(PositionalBody, LoadsAreWhatForceHasOfABodyAtRest) {
  for (const NamedSettings& named : pointwise_settings()) {
    const auto body = make_body(named.settings);
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(body->dofs());
    Eigen::VectorXd loads;
    PositionalBody(body, PositionalVerbs::points).loads(0.9, loads);
    EXPECT_LT((loads - force(*body, 0.9, still, still)).norm(), 1e-10 * loads.norm()) << named.name;
  }
}

/// Each once, and none that acts on another of its colour.
void expect_colouring(const Colours& colours, Eigen::Index count,
                      const std::function<bool(std::int32_t, std::int32_t)>& act_on_each_other) {
  std::set<std::int32_t> seen;
  for (const std::vector<std::int32_t>& colour : colours)
    for (std::size_t i = 0; i < colour.size(); ++i) {
      EXPECT_TRUE(seen.insert(colour[i]).second);
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_FALSE(act_on_each_other(colour[i], colour[j])) << colour[i] << ", " << colour[j];
    }
  EXPECT_EQ(static_cast<Eigen::Index>(seen.size()), count);
}

TEST(PositionalBody, PointsOfOneColourDoNotActOnEachOther) {
  for (const NamedSettings& named : pointwise_settings()) {
    const auto body = make_body(named.settings);
    const Eigen::VectorXd q = random_vector(body->dofs(), 4e-3, 1), still = Eigen::VectorXd::Zero(q.size());
    const Eigen::MatrixXd K = stiffness(*body, 0, q, still);
    const PositionalBody points(body, PositionalVerbs::points);
    expect_colouring(points.point_colours(), body->dofs() / 3, [&](std::int32_t i, std::int32_t j) {
      return !K.block<3, 3>(Eigen::Index{3} * i, Eigen::Index{3} * j).isZero(0);
    });
  }
}

TEST(PositionalBody, WeightsAreAtLeastHalfTheStiffnessAtRest) {
  // What iterations with them leave of an error, 1 - K / W, lies between -1 and 1.
  for (const NamedSettings& named : pointwise_settings()) {
    const auto body = make_body(named.settings);
    const auto shared_weights = PositionalBody(body, PositionalVerbs::weights).weights();
    const Eigen::SparseMatrix<double>& weights = *shared_weights;
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(body->dofs(), body->dofs());
    for (Eigen::Index column = 0; column < weights.cols(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(weights, column); entry; ++entry)
        W.block<3, 3>(3 * entry.row(), 3 * column).diagonal().setConstant(entry.value());
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(body->dofs());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> shares(stiffness(*body, 0, still, still),
                                                                           W);
    EXPECT_GT(shares.eigenvalues().minCoeff(), 0) << named.name;
    EXPECT_LT(shares.eigenvalues().maxCoeff(), 2) << named.name;
    // Springs resist no more than their weights.
    if (body->settings().model.is_of_springs()) {
      EXPECT_LT(shares.eigenvalues().maxCoeff(), 1 + 1e-12) << named.name;
    }
  }
}

TissueSettings constrained(std::string_view model) {
  TissueSettings settings;
  settings.model = tissue_model(model);
  settings.materials = two_materials();
  settings.supports = {{points_in_box(uneven_box(), {-1, -1, -1}, {0.01, 1, 1})}};
  settings.elastic_supports = {{{9, 20, 35}, {40, 300, 20}}};
  return settings;
}

std::vector<CompliantConstraint> constraints_of(const PositionalBody& system, const Eigen::VectorXd& q,
                                                std::span<const std::int32_t> numbers) {
  std::vector<CompliantConstraint> at(numbers.size());
  system.constraints(q, numbers, at);
  return at;
}

CompliantConstraint constraint_of(const PositionalBody& system, const Eigen::VectorXd& q, std::int32_t c) {
  return constraints_of(system, q, {&c, 1}).front();
}

TEST(PositionalBody, ConstraintsSideBySideAreThoseOneByOne) {
  for (const char* model : {"mass_spring", "fem_neo_hookean"}) {
    const auto body = make_body(constrained(model));
    const PositionalBody system(body, PositionalVerbs::constraints);
    const Eigen::VectorXd q = random_vector(body->dofs(), 4e-3, 1);
    for (const std::vector<std::int32_t>& colour : system.constraint_colours()) {
      const std::vector<CompliantConstraint> all = constraints_of(system, q, colour);
      for (std::size_t i = 0; i < colour.size(); ++i) {
        const CompliantConstraint alone = constraint_of(system, q, colour[i]);
        EXPECT_EQ(all[i].value, alone.value);
        EXPECT_EQ(all[i].compliance, alone.compliance);
        ASSERT_EQ(all[i].points, alone.points);
        for (std::size_t a = 0; a < alone.points; ++a) {
          EXPECT_EQ(all[i].point[a], alone.point[a]);
          EXPECT_EQ(all[i].gradient[a], alone.gradient[a]);
        }
      }
    }
  }
}

TEST(PositionalBody, ConstraintsHaveTheGradientsOfTheirValues) {
  for (const char* model : {"mass_spring", "fem_neo_hookean"}) {
    const auto body = make_body(constrained(model));
    const PositionalBody system(body, PositionalVerbs::constraints);
    const Eigen::VectorXd q = random_vector(body->dofs(), 4e-3, 1);
    for (const std::vector<std::int32_t>& colour : system.constraint_colours())
      for (const std::int32_t c : colour) {
        const CompliantConstraint at = constraint_of(system, q, c);
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(q.size());
        for (std::size_t i = 0; i < at.points; ++i)
          gradient.segment<3>(Eigen::Index{3} * at.point[i]) += at.gradient[i];
        const Eigen::VectorXd along = random_vector(q.size(), 1, 100 + static_cast<unsigned>(c));
        const auto value = [&](double s) { return constraint_of(system, q + s * along, c).value; };
        const double d = 1e-6;
        EXPECT_NEAR((value(d) - value(-d)) / (2 * d), gradient.dot(along), 1e-6 * (1 + gradient.norm()))
            << model << ", " << c;
      }
  }
}

TEST(PositionalBody, ConstraintsHaveTheForcesOfTheBody) {
  // -C dC / alpha summed: of springs the elastic force itself, of a solid that of small strains.
  for (const char* model : {"mass_spring", "fem_neo_hookean"})
    for (const double size : {1e-4, 1e-5}) {
      const auto body = make_body(constrained(model));
      const PositionalBody system(body, PositionalVerbs::constraints);
      const Eigen::VectorXd q = random_vector(body->dofs(), size, 1), still = Eigen::VectorXd::Zero(q.size());
      Eigen::VectorXd f = still;
      for (const std::vector<std::int32_t>& colour : system.constraint_colours())
        for (const CompliantConstraint& at : constraints_of(system, q, colour))
          for (std::size_t i = 0; i < at.points; ++i)
            f.segment<3>(Eigen::Index{3} * at.point[i]) -= at.value / at.compliance * at.gradient[i];
      const Eigen::VectorXd wanted = force(*body, 0, q, still);
      const double share = body->settings().model.is_of_springs() ? 1e-9 : 40 * size / 0.03;
      EXPECT_LT((f - wanted).norm(), share * wanted.norm()) << model << ", " << size;
    }
}

TEST(PositionalBody, ConstraintsOfOneColourShareNoPoint) {
  for (const char* model : {"mass_spring", "fem_neo_hookean"}) {
    const auto body = make_body(constrained(model));
    const PositionalBody system(body, PositionalVerbs::constraints);
    const Eigen::VectorXd q = Eigen::VectorXd::Zero(body->dofs());
    std::size_t count = 0;
    for (const std::vector<std::int32_t>& colour : system.constraint_colours()) count += colour.size();
    const auto points = [&](std::int32_t c) {
      const CompliantConstraint at = constraint_of(system, q, c);
      return std::set<std::int32_t>(at.point.begin(),
                                    at.point.begin() + static_cast<std::ptrdiff_t>(at.points));
    };
    expect_colouring(system.constraint_colours(), static_cast<Eigen::Index>(count),
                     [&](std::int32_t i, std::int32_t j) {
                       const std::set<std::int32_t> own = points(i);
                       for (const std::int32_t point : points(j))
                         if (own.contains(point)) return true;
                       return false;
                     });
    const auto& sets = body->spring_sets();
    EXPECT_EQ(count, 9 + (sets.empty() ? 2 * static_cast<std::size_t>(body->mesh().tetrahedron_count())
                                       : sets.front().size()))
        << model;
  }
}

TEST(PositionalBody, SaysWhichBodiesItDoesNotTake) {
  const auto why = [](const auto& change, PositionalVerbs verbs) {
    TissueSettings settings = constrained("mass_spring");
    change(settings);
    return PositionalBody::why_not(*make_body(settings), verbs);
  };
  using Settings = TissueSettings;
  const PositionalVerbs points = PositionalVerbs::points, constraints = PositionalVerbs::constraints;
  EXPECT_EQ(why([](Settings&) {}, points), "");
  EXPECT_EQ(why([](Settings&) {}, constraints), "");
  const auto expect = [&](const std::string& words, PositionalVerbs verbs, const auto& change) {
    EXPECT_NE(why(change, verbs).find(words), std::string::npos) << words << ": " << why(change, verbs);
    EXPECT_EQ(why(change, PositionalVerbs::forces), "");
    EXPECT_THROW(
        {
          TissueSettings settings = constrained("mass_spring");
          change(settings);
          PositionalBody(make_body(settings), verbs);
        },
        std::invalid_argument);
  };
  for (const PositionalVerbs verbs : {points, constraints, PositionalVerbs::weights}) {
    expect("a tool touches the body", verbs, [](Settings& s) { s.tools.resize(1); });
    expect("one of them moves", verbs, [](Settings& s) { s.supports.front().travel = {0, 0, 1e-3}; });
    expect("a skin", verbs, [](Settings& s) { s.skin.kind = SkinSettings::Kind::membrane; });
    expect("dampers of springs", verbs, [](Settings& s) { s.springs.damper = 1; });
    expect("fibres", verbs, [](Settings& s) {
      s.model = tissue_model("fem_neo_hookean");
      s.materials[0].fibre_young = 1e3;
      s.materials[0].fibre_x = 1;
    });
    expect("fem_nodal_pressure", verbs, [](Settings& s) { s.model = tissue_model("fem_nodal_pressure"); });
  }
  expect("fem_green", constraints, [](Settings& s) { s.model = tissue_model("fem_green"); });
  expect("leave cubic", constraints, [](Settings& s) { s.springs.law = CubicSpring{}; });
}

}  // namespace
}  // namespace hmax
