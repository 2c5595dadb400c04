/// Bodies and runs that devices and the processor have to agree on.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax::device_tests {

/// Numbers that differ in their bits; of zeros the sign counts.
inline std::size_t unequal(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return static_cast<std::size_t>(std::max(a.size(), b.size()));
  std::size_t count = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    count += std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i]);
  return count;
}

inline void expect_equal(const RunRecord& found, const RunRecord& expected, const std::string& id) {
  EXPECT_EQ(found.outcome, expected.outcome) << id;
  EXPECT_EQ(found.t, expected.t) << id;
  EXPECT_EQ(found.t_state, expected.t_state) << id;
  EXPECT_EQ(found.note, expected.note) << id;
  EXPECT_EQ(found.stats, expected.stats) << id << ", rhs " << found.stats.rhs << " of " << expected.stats.rhs;
  EXPECT_EQ(unequal(found.y, expected.y), 0U) << id << " of " << expected.y.size();
  EXPECT_GT(expected.y.norm(), 0);
}

/// @returns the run on the processor
inline RunRecord expect_same(Device& device, const Problem& problem, const std::string& id,
                             const RunSpec& spec, std::int64_t seen_every = 7) {
  const Method method = find_method(id);
  EXPECT_EQ(unsuited_for_device(problem, method), "");
  const Method there = on_device(method, std::shared_ptr<Device>(&device, [](Device*) {}));
  using Points = std::vector<std::pair<double, Eigen::VectorXd>>;
  const auto into = [](Points& points) {
    return [&points](double t, const Eigen::Ref<const Eigen::VectorXd>& y) { points.emplace_back(t, y); };
  };
  Points steps, seen;
  RunSpec seldom = spec;
  seldom.seen_every = seen_every;
  RunRecord expected = method.bind(problem).run(spec, into(steps));
  const RunRecord found = there.bind(problem).run(seldom, into(seen));
  std::size_t n = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i % static_cast<std::size_t>(seen_every) != 0 &&
        (i + 1 < steps.size() || expected.outcome == Outcome::diverged))
      continue;
    if (n >= seen.size()) break;
    EXPECT_EQ(seen[n].first, steps[i].first) << id;
    EXPECT_EQ(unequal(seen[n].second, steps[i].second), 0U) << id << " at " << steps[i].first;
    ++n;
  }
  EXPECT_EQ(n, seen.size()) << id;
  expect_equal(found, expected, id);
  return expected;
}

inline Problem body_of(const TetMesh& mesh, const TissueSettings& settings) {
  const auto body = std::make_shared<TissueBody>(mesh, settings);
  Problem problem = with_body(make_problem("fem_green@cube:n=1"), body);
  problem.y0 = body->y0();
  return problem;
}

/// The same mesh with its points and tetrahedra in another order, corners of tetrahedra too.
inline TetMesh shuffled(const TetMesh& mesh) {
  std::mt19937_64 random(11);
  std::vector<TetMesh::Index> place(static_cast<std::size_t>(mesh.point_count()));
  std::iota(place.begin(), place.end(), 0);
  std::ranges::shuffle(place, random);
  TetMesh other = mesh;
  for (Eigen::Index p = 0; p < mesh.point_count(); ++p)
    other.points.col(place[static_cast<std::size_t>(p)]) = mesh.points.col(p);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(mesh.tetrahedron_count()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::shuffle(order, random);
  for (std::size_t t = 0; t < order.size(); ++t) {
    for (Eigen::Index a = 0; a < 4; ++a)  // a turn of three corners keeps the sign of the volume
      other.tetrahedra(a == 3 ? 3 : (a + order[t]) % 3, static_cast<Eigen::Index>(t)) =
          place[static_cast<std::size_t>(mesh.tetrahedra(a, order[t]))];
    if (!mesh.regions.empty()) other.regions[t] = mesh.regions[static_cast<std::size_t>(order[t])];
  }
  return other;
}

/// Two regions, a held end, gravity, damping by mass and two loads on some of the same points.
inline Problem uneven_body(double alpha, const char* model = "fem_green",
                           SkinSettings::Kind skin = SkinSettings::Kind::none) {
  TissueSettings settings;
  settings.model = tissue_model(model);
  TetMesh mesh = tissue_tests::mesh_for(settings.model, shuffled(tissue_tests::uneven_box()));
  if (settings.model.has_ten_nodes) tissue_tests::bend_sides(mesh, 0.002);
  settings.springs.law = CubicSpring{4};
  settings.skin.kind = skin;
  settings.skin.young = 1e5;
  settings.materials = tissue_tests::two_materials();
  settings.alpha = alpha;
  settings.gravity = {0.3, -1, -9.81};
  settings.supports = {{points_in_box(mesh, {-1, -1, -1}, {0.01, 1, 1})}};
  const std::vector<TetMesh::Index> pressed = points_in_box(mesh, {0.1, -1, -1}, {1, 1, 1}),
                                    pulled = points_in_box(mesh, {0.13, -1, -1}, {1, 1, 1});
  settings.forces = {{pressed, {0.1, -0.2, 0.05}}, {pulled, {-0.03, 0.3, 0.4}}};
  return body_of(mesh, settings);
}

/// The same with fibres in one of its regions, or in both.
inline Problem fibrous_body(const Problem& body, bool both = false) {
  TissueSettings settings = body.body->settings();
  const TissueMaterial fibres{.fibre_young = 2e4, .fibre_x = 1, .fibre_y = 0.5, .fibre_z = -0.3};
  for (std::size_t n = both ? 0 : 1; n < settings.materials.size(); ++n) {
    TissueMaterial& material = settings.materials[n];
    material.fibre_young = fibres.fibre_young * static_cast<double>(n + 1);
    material.fibre_x = fibres.fibre_x, material.fibre_y = fibres.fibre_y, material.fibre_z = fibres.fibre_z;
  }
  return body_of(body.body->mesh(), settings);
}

/// A model and the parameters that give it parts beside its tetrahedra.
struct Parts {
  const char* model;
  Parameters parameters{};
  [[nodiscard]] Problem on(const std::string& mesh, Parameters more = {{"g", 9.81}}) const {
    more.insert(more.end(), parameters.begin(), parameters.end());
    return make_problem(model + mesh, {.parameters = more});
  }
};
inline const Parts of_pressures{"fem_nodal_pressure"};
inline const Parts of_ten_nodes{"fem_quadratic"};
inline const Parts fibrous{"fem_green", {{"fibre_E", 2e4}, {"fibre_x", 1}, {"fibre_z", 0.4}}};

/// Springs with dampers, and another set of springs on the surface, which begin to move.
inline Problem damped_body(double alpha, double beta) {
  const Problem still = uneven_body(alpha, "mass_spring", SkinSettings::Kind::springs);
  TissueSettings settings = still.body->settings();
  settings.beta = beta;
  settings.springs.damper = 0.02;
  settings.springs.damper_time = 1e-4;
  Problem problem = body_of(still.body->mesh(), settings);
  problem.y0 = tissue_tests::random_vector(problem.y0.size(), 0.002, 5);
  return problem;
}

/// Held at an end that ramps and swings at once, part of which has another motion, and on springs.
inline Problem moving_body(double beta, const char* model = "fem_green",
                           SkinSettings::Kind skin = SkinSettings::Kind::none) {
  const Problem still = uneven_body(2.5, model, skin);
  TissueSettings settings = still.body->settings();
  settings.beta = beta;
  settings.springs.damper = 0.02;
  using Kind = TimeProfile::Kind;
  const std::vector<TetMesh::Index> held = settings.supports[0].points, half(held.begin(), held.begin() + 4),
                                    &free = still.body->free_points();
  settings.supports = {{held, {0.004, 0, 0.002}, {.kind = Kind::ramp, .start = 0.002, .rise = 0.01}},
                       {held, {0, -0.001, 0.001}, {.kind = Kind::sine, .start = 0.001, .omega = 300}},
                       {half, {0.001, 0.002, 0}, {.kind = Kind::sine, .omega = 200}},
                       {{held.back(), free[7]}},
                       {{free[9]}, {0.0005, 0, 0}}};
  settings.elastic_supports = {{{free[0], free[3], free[9]}, {40, 300, 20}}, {{free[3]}, {10}}};
  return body_of(still.body->mesh(), settings);
}

/// A body whose points begin at F X: turned inside out, flat, or at one place.
/// @param F  its diagonal
inline Problem pressed_body(const Eigen::Vector3d& F, Problem problem) {
  const std::vector<TetMesh::Index>& free = problem.body->free_points();
  for (std::size_t i = 0; i < free.size(); ++i)
    problem.y0.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        (F.array() - 1).matrix().cwiseProduct(problem.body->mesh().points.col(free[i]));
  return problem;
}

inline Problem pressed_body(const Eigen::Vector3d& F, const char* model = "fem_corotational") {
  return pressed_body(F, uneven_body(2.5, model));
}

inline const std::array<Eigen::Vector3d, 4> pressed{Eigen::Vector3d{1.1, 0.9, -0.5},
                                                    Eigen::Vector3d{1, 1, -1}, Eigen::Vector3d{1, 0.8, 0},
                                                    Eigen::Vector3d{0, 0, 0}};

/// Loads that come, go and oscillate.
inline Problem driven_body(const Problem& steady = uneven_body(2.5)) {
  TissueSettings settings = steady.body->settings();
  using Kind = TimeProfile::Kind;
  settings.forces[0].profile = {.kind = Kind::ramp, .start = 0.002, .rise = 0.01};
  settings.forces[1].profile = {.kind = Kind::sine, .start = 0.001, .omega = 300};
  settings.forces.push_back(settings.forces[0]);
  settings.forces.back().profile = {};
  return body_of(steady.body->mesh(), settings);
}

/// @returns the run on the processor
inline RunRecord expect_same_chosen(Device& device, const Problem& problem, const std::string& id,
                                    RunSpec spec) {
  spec.adaptive = true;
  const Method method = find_method(id);
  RunRecord expected = method.bind(problem).run(spec, {});
  expect_equal(run_on_device(device, problem, method, spec).record, expected,
               id + ", rtol " + std::to_string(spec.rtol));
  return expected;
}

/// Bodies from different states, each with the bits that it has alone.
template <class Real = double>
void expect_same_at_a_time(Device& device, const Problem& problem, const char* id, std::int32_t count) {
  const DeviceMethod method = *device_method(find_method(id));
  const auto run = [&](BodyOnDevice<Real>& body) {
    std::vector<double> times{0.0};
    const auto tell_times = [&] {
      if (body.is_driven()) body.set_times(times);
    };
    tell_times();
    body.start();
    for (const std::int64_t steps : {31, 8}) {
      times.clear();
      for (std::int64_t n = 0; n < steps; ++n)
        method.append_times(1e-3 * static_cast<double>(n), 1e-3, {}, times);
      tell_times();
      body.advance(1e-4, steps);
    }
  };
  std::vector<Eigen::VectorXd> starts;
  for (std::int32_t n = 0; n < count; ++n)
    starts.push_back(problem.y0 + 1e-4 * n * Eigen::VectorXd::LinSpaced(problem.y0.size(), -1, 1));
  BodyOnDevice<Real> all(device, *problem.body, method, count), alone(device, *problem.body, method);
  all.set(starts);
  run(all);
  for (std::int32_t n = 0; n < count; ++n) {
    alone.set({&starts[static_cast<std::size_t>(n)], 1});
    run(alone);
    EXPECT_EQ(unequal(all.get(n), alone.get()), 0U) << id << ", body " << n;
    EXPECT_GT(unequal(all.get(n), all.get((n + 1) % count)), 0U);
  }
}

/// How far single precision is from double: the largest difference of displacements over the largest of them.
inline double error_of_single(const Problem& problem, const char* method, const RunSpec& spec) {
  HostDevice device;
  const RunRecord expected = find_method(method).bind(problem).run(spec, {}),
                  found =
                      run_on_device(device, problem, find_method(method), spec, Precision::single_precision)
                          .record;
  EXPECT_EQ(found.outcome, expected.outcome);
  EXPECT_EQ(found.t, expected.t);
  EXPECT_EQ(found.stats.steps, expected.stats.steps);
  const Eigen::Index n = expected.y.size() / 2;
  return (found.y - expected.y).head(n).lpNorm<Eigen::Infinity>() /
         expected.y.head(n).lpNorm<Eigen::Infinity>();
}

}  // namespace hmax::device_tests
