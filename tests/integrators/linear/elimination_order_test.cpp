/// Orders of elimination against an elimination that keeps every set of neighbours, and what METIS must leave
/// alone.
#include "integrators/linear/elimination_order.hpp"

#include <algorithm>
#include <atomic>
#include <bitset>
#include <csignal>
#include <cstdlib>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/linear/panel_analysis.hpp"

namespace hmax {
namespace {

using Vertex = Graph::Index;
using Indices = std::vector<Vertex>;
using Edges = std::vector<std::pair<Vertex, Vertex>>;

Graph graph_of(Vertex vertices, const Edges& edges) {
  std::vector<Indices> neighbours(static_cast<std::size_t>(vertices));
  for (const auto& [a, b] : edges) {
    neighbours[static_cast<std::size_t>(a)].push_back(b);
    neighbours[static_cast<std::size_t>(b)].push_back(a);
  }
  Graph graph;
  for (const Indices& of : neighbours) {
    graph.to.insert(graph.to.end(), of.begin(), of.end());
    graph.first.push_back(static_cast<Vertex>(graph.to.size()));
  }
  return graph;
}

/// The points of a cube, each beside those next to it along the axes.
Graph cube(Vertex side) {
  Edges edges;
  for (Vertex z = 0; z < side; ++z)
    for (Vertex y = 0; y < side; ++y)
      for (Vertex x = 0; x < side; ++x) {
        const Vertex a = (z * side + y) * side + x;
        if (x + 1 < side) edges.emplace_back(a, a + 1);
        if (y + 1 < side) edges.emplace_back(a, a + side);
        if (z + 1 < side) edges.emplace_back(a, a + side * side);
      }
  return graph_of(side * side * side, edges);
}

/// Operations of the elimination of matrices with three unknowns a vertex: the sum over the columns of their
/// entries from the diagonal down, squared. The elimination of a vertex makes a clique of its neighbours.
constexpr Vertex unknowns = 3, most_vertices = 1728;
double work_of(const Graph& graph, const Indices& order) {
  using Neighbours = std::bitset<most_vertices>;
  std::vector<Neighbours> left(static_cast<std::size_t>(graph.size()));
  for (Vertex v = 0; v < graph.size(); ++v)
    for (const Vertex u : graph.of(v)) left[static_cast<std::size_t>(v)].set(static_cast<std::size_t>(u));
  double work = 0;
  for (const Vertex vertex : order) {
    const auto v = static_cast<std::size_t>(vertex);
    const auto below = static_cast<double>(unknowns * left[v].count());
    for (Vertex k = 1; k <= unknowns; ++k) work += (below + k) * (below + k);
    for (std::size_t u = 0; u < left.size(); ++u)
      if (left[v][u]) {
        left[u] |= left[v];
        left[u].reset(u);
        left[u].reset(v);
      }
  }
  return work;
}

/// The work of the plan for such a matrix.
double planned_work(const Graph& graph) {
  Indices outer{0}, inner;
  for (Vertex v = 0; v < graph.size(); ++v) {
    Indices rows(graph.of(v).begin(), graph.of(v).end());
    rows.push_back(v);
    std::ranges::sort(rows);
    for (Vertex c = 0; c < unknowns; ++c) {
      for (const Vertex u : rows)
        for (Vertex r = 0; r < unknowns; ++r) inner.push_back(unknowns * u + r);
      outer.push_back(static_cast<Vertex>(inner.size()));
    }
  }
  return PanelAnalysis(outer, inner).work;
}

bool has_nested_dissection() { return !nested_dissection(cube(3)).empty(); }

TEST(EliminationOrder, NamesEveryVertexOnce) {
  Edges path, star, wheel, full, nearly_full, pairs;
  for (Vertex i = 1; i < 3000; ++i) {
    path.emplace_back(i - 1, i);
    star.emplace_back(0, i);
    if (i % 2 == 1) pairs.emplace_back(i - 1, i);
  }
  wheel = star;
  wheel.insert(wheel.end(), path.begin() + 1, path.end());
  for (Vertex i = 1; i < 300; ++i)
    for (Vertex j = 0; j < i; ++j) {
      full.emplace_back(i, j);
      if (i < 150 && (i % 2 == 0 || j + 1 < i)) nearly_full.emplace_back(i, j);
    }
  for (const Graph& graph :
       {graph_of(3000, path), graph_of(3000, star), graph_of(3000, wheel), graph_of(300, full),
        graph_of(150, nearly_full), graph_of(3000, pairs), graph_of(1, {}), graph_of(500, {}), cube(12)}) {
    Indices all(static_cast<std::size_t>(graph.size()));
    std::iota(all.begin(), all.end(), 0);
    for (Indices order : {minimum_degree(graph), nested_dissection(graph)}) {
      if (order.empty()) continue;  // built without METIS
      std::ranges::sort(order);
      EXPECT_EQ(order, all);
    }
  }
}

TEST(EliminationOrder, ThePlanTakesTheOneOfLessWork) {
  for (const Vertex side : {5, 12}) {
    const Graph graph = cube(side);
    const double by_degree = work_of(graph, minimum_degree(graph));
    // The small cube is not worth a dissection, the large one is.
    ASSERT_EQ(by_degree > dissection_work(graph), side == 12);
    const Indices order = nested_dissection(graph);
    const bool dissected = side == 12 && !order.empty();
    const double least = dissected ? work_of(graph, order) : by_degree;
    // Panels add a few zeros.
    EXPECT_GE(planned_work(graph), least);
    EXPECT_LT(planned_work(graph), dissected ? by_degree : 1.3 * by_degree);
  }
}

TEST(NestedDissection, GivesTheSameInEveryThreadAndLeavesRandomNumbersAlone) {
  if (!has_nested_dissection()) GTEST_SKIP() << "built without METIS";
  const Graph graph = cube(12);
  const Indices expected = nested_dissection(graph);
  std::srand(7);
  std::vector<int> random;
  for (int i = 0; i < 3; ++i) random.push_back(std::rand());
  std::srand(7);
  EXPECT_EQ(std::rand(), random[0]);
  std::vector<Indices> orders(4);
  {
    std::vector<std::jthread> threads;
    for (Indices& order : orders) threads.emplace_back([&] { order = nested_dissection(graph); });
  }
  for (const Indices& order : orders) EXPECT_EQ(order, expected);
  EXPECT_EQ(std::rand(), random[1]);
  EXPECT_EQ(std::rand(), random[2]);
}

TEST(NestedDissection, LeavesSignalsAlone) {
  if (!has_nested_dissection()) GTEST_SKIP() << "built without METIS";
  const auto handler_of = [](int signal) {
    struct sigaction now {};
    sigaction(signal, nullptr, &now);
    return now.sa_handler;
  };
  const Graph graph = cube(16);
  const auto term = handler_of(SIGTERM), abort = handler_of(SIGABRT);
  std::atomic<bool> done = false;
  std::jthread order([&] {
    nested_dissection(graph);
    done = true;
  });
  bool same = true;
  while (!done) same = same && handler_of(SIGTERM) == term && handler_of(SIGABRT) == abort;
  EXPECT_TRUE(same);
}

}  // namespace
}  // namespace hmax
