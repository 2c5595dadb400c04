// Measures the forces and stiffness of tissue models beside plain scalar forms of them.
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <benchmark/benchmark.h>

#include "bench/micro/plain_tissue.hpp"
#include "bench/micro/start.hpp"
#include "bench/micro/tissue_costs.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/renumber.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/forces/green_elements.hpp"

namespace hmax {
namespace {

using Index = TetMesh::Index;
using Eigen::Vector3d;
using micro::BodyCounts, micro::Cost;

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

/// A box of about so many tetrahedra, numbered for locality or at random as a mesh generator may leave it.
TetMesh mesh_of(int tetrahedra, bool shuffled) {
  static const std::map<int, Eigen::Vector3i> cells{
      {1152, {8, 6, 4}}, {10368, {12, 12, 12}}, {101400, {26, 26, 25}}, {998250, {55, 55, 55}}};
  const Eigen::Vector3i& n = cells.at(tetrahedra);
  TetMesh mesh = box_mesh(0.2 / n[0] * n.cast<double>(), n);
  std::mt19937_64 random(7);
  Renumbering order;
  for (Index i = 0; i < mesh.point_count(); ++i) order.points.push_back(i);
  for (Index i = 0; i < mesh.tetrahedron_count(); ++i) order.tetrahedra.push_back(i);
  std::shuffle(order.points.begin(), order.points.end(), random);
  std::shuffle(order.tetrahedra.begin(), order.tetrahedra.end(), random);
  mesh = renumbered(mesh, order);
  return shuffled ? mesh : renumbered(mesh, local_order(mesh));
}

/// Everything that is measured on one mesh.
struct Case {
  TetMesh mesh;
  MeshEdges edges;
  BlockPattern pattern;
  plain::Green plain_green;
  plain::Springs plain_springs;
  GreenElements green;
  SpringSet springs;
  std::vector<double> x, f;
  NodeRows u_rows, x_rows, f_rows;  // displacements, positions, forces
  BlockPattern::Matrix K;

  Case(int tetrahedra, bool shuffled)
      : mesh(mesh_of(tetrahedra, shuffled)),
        edges(edges_of(mesh)),
        pattern(numbers(), edges),
        plain_green(mesh, lame(5300, 0.45)),
        green(mesh, std::vector{lame(5300, 0.45)}, pattern),
        springs(mesh.points, springs_of(), LinearSpring{}, pattern),
        x(at(mesh.points.size())),
        f(x.size()),
        u_rows(at(mesh.point_count())),
        x_rows(u_rows.size()),
        f_rows(x_rows.size()) {
    plain_green.place(pattern);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> by(-1e-4, 1e-4);
    for (std::size_t i = 0; i < u_rows.size(); ++i) {
      as_vector(u_rows[i]) = Vector3d::NullaryExpr([&] { return by(random); });
      as_vector(x_rows[i]) = mesh.points.col(static_cast<Eigen::Index>(i)) + as_vector(u_rows[i]);
      Eigen::Map<Vector3d>(x.data() + 3 * i) = as_vector(x_rows[i]);
    }
    pattern.clear(K);
  }
  [[nodiscard]] std::vector<Index> numbers() const {
    std::vector<Index> all(at(mesh.point_count()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    return all;
  }
  std::vector<SpringSet::Spring> springs_of() {
    std::vector<SpringSet::Spring> all;
    for (const auto& edge : edges.colwise()) {
      all.push_back({{edge[0], edge[1]}, 10});
      plain_springs.springs.push_back(
          {edge[0], edge[1], (mesh.points.col(edge[1]) - mesh.points.col(edge[0])).norm(), 10});
    }
    return all;
  }
};

enum class Task { force, springs, stiffness };
constexpr std::array tasks{Task::force, Task::springs, Task::stiffness};
constexpr std::array sizes{1152, 10368, 101400, 998250};

const char* name_of(Task task) {
  return task == Task::force ? "Green force" : task == Task::springs ? "springs" : "Green stiffness";
}

/// One evaluation into cleared memory. @param plain  the scalar form, else the one of the library
void evaluate(Case& c, Task task, bool plain) {
  if (task == Task::stiffness) {
    if (plain) {
      c.pattern.clear(c.K);
      c.plain_green.stiffness(c.x.data(), c.pattern, c.K.valuePtr());
    } else {
      c.pattern.shape(c.K);
      c.green.write_stiffness(c.u_rows, c.pattern, c.K.valuePtr());
    }
  } else if (plain) {
    std::fill(c.f.begin(), c.f.end(), 0.0);
    task == Task::force ? c.plain_green.force(c.x.data(), c.f.data())
                        : c.plain_springs.force(c.x.data(), c.f.data());
  } else {
    std::fill(c.f_rows.begin(), c.f_rows.end(), NodeRow{});
    task == Task::force ? c.green.add_force(c.u_rows, c.f_rows) : c.springs.add_force(c.x_rows, c.f_rows);
  }
}

Cost cost_of(const Case& c, Task task) {
  const BodyCounts body{.points = static_cast<double>(c.mesh.point_count()),
                        .edges = static_cast<double>(c.edges.cols()),
                        .tetrahedra = static_cast<double>(c.mesh.tetrahedron_count()),
                        .entries = static_cast<double>(c.K.nonZeros())};
  return task == Task::force     ? cost_of_force(body)
         : task == Task::springs ? cost_of_springs(body)
                                 : cost_of_stiffness(body);
}

struct Measurement {
  Task task;
  int size;
  bool shuffled, plain;
  double elements;
  Cost cost;
  std::vector<double> seconds = {};
};

double median(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Bytes per second that one core reads and writes in a = b + s c over arrays beyond the caches.
double peak_bytes() {
  constexpr std::size_t n = 12000000;
  std::vector<double> a(n, 1), b(n, 2), c(n, 3);
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    const double start = cpu_seconds();
    for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + 3 * c[k];
    benchmark::DoNotOptimize(a.data());
    seconds.push_back(cpu_seconds() - start);
  }
  return 24. * static_cast<double>(n) / median(seconds);
}

void print_table(const std::map<std::string, Measurement>& measurements, double bytes) {
  std::printf(
      "| task | tetrahedra | numbering | plain | eight at a time | ratio | GFLOP/s | of the memory bandwidth |\n"
      "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: |\n");
  for (const Task task : tasks)
    for (const int size : sizes)
      for (const bool shuffled : {false, true}) {
        const Measurement *plain = nullptr, *fast = nullptr;
        for (const auto& [name, m] : measurements)
          if (m.task == task && m.size == size && m.shuffled == shuffled && !m.seconds.empty())
            (m.plain ? plain : fast) = &m;
        if (!plain || !fast) continue;
        const double slow = median(plain->seconds) / plain->elements,
                     quick = median(fast->seconds) / fast->elements;
        std::printf("| %s | %d | %s | %.1f ns | %.1f ns | **%.2f** | %.1f | %.0f %% |\n", name_of(task), size,
                    shuffled ? "at random" : "local", slow * 1e9, quick * 1e9, slow / quick,
                    fast->cost.operations / quick * 1e-9, 100 * fast->cost.bytes / quick / bytes);
      }
  std::printf("\nMedians of CPU time per element, instruction set %s. One core: %.1f GB/s in a = b + s c.\n",
              tissue_kernels().name, bytes * 1e-9);
}

int main_of(int argc, char** argv) {
  const auto ratios = micro::start(argc, argv, 9, 0.02);
  if (!ratios) return 2;

  micro::Collector collector(*ratios);
  std::map<std::string, Measurement> measurements;
  // One mesh in memory at a time: they are built on demand and leave with their measurements.
  for (const int size : sizes)
    for (const bool shuffled : {false, true}) {
      benchmark::ClearRegisteredBenchmarks();
      const auto c = std::make_shared<std::unique_ptr<Case>>();
      for (const Task task : tasks)
        for (const bool plain : {true, false}) {
          const std::string name = std::string(name_of(task)) + (plain ? "/plain/" : "/eight/") +
                                   (shuffled ? "random/" : "local/") + std::to_string(size);
          Measurement& m = measurements[name];
          m = {task, size, shuffled, plain, 0, {}};
          benchmark::RegisterBenchmark(name.c_str(), [c, &m](benchmark::State& state) {
            if (!*c) *c = std::make_unique<Case>(m.size, m.shuffled);
            Case& here = **c;
            m.elements = static_cast<double>(m.task == Task::springs ? here.edges.cols()
                                                                     : here.mesh.tetrahedron_count());
            evaluate(here, m.task, m.plain);
            m.cost = cost_of(here, m.task);
            for (auto _ : state) evaluate(here, m.task, m.plain);
          })->Unit(benchmark::kMicrosecond);
        }
      benchmark::RunSpecifiedBenchmarks(&collector);
    }
  benchmark::Shutdown();
  for (auto& [name, measurement] : measurements) measurement.seconds = collector.seconds[name];
  print_table(measurements, peak_bytes());
  return 0;
}

}  // namespace
}  // namespace hmax

int main(int argc, char** argv) { return hmax::main_of(argc, argv); }
