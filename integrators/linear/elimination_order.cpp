#include "integrators/linear/elimination_order.hpp"

#include <mutex>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#ifdef HMAX_HAVE_METIS
#include <metis.h>
#endif

namespace hmax {

std::vector<Graph::Index> minimum_degree(const Graph& graph) {
  using Index = Graph::Index;
  const Index n = graph.size();
  Eigen::SparseMatrix<double> pattern(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < n; ++v) {
    entries.emplace_back(v, v, 1);
    for (const Index u : graph.of(v)) entries.emplace_back(u, v, 1);
  }
  // With the diagonal, as Eigen's ordering asks for it.
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Eigen::AMDOrdering<Index>()(pattern, order);
  return {order.indices().data(), order.indices().data() + n};
}

#ifdef HMAX_HAVE_METIS
namespace {

/// METIS draws from rand(). As long as this lives, no other thread of hmax does, and what rand() gives the
/// program afterwards is what it would have given.
class OwnRandomNumbers {
 public:
  OwnRandomNumbers() : lock_(mutex()), before_(initstate(1, state, sizeof state)) {}
  ~OwnRandomNumbers() { setstate(before_); }
  OwnRandomNumbers(const OwnRandomNumbers&) = delete;
  OwnRandomNumbers& operator=(const OwnRandomNumbers&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  // A thread that takes it for the state before keeps it.
  alignas(long) static inline char state[128];
  char* before_;
};

/// METIS ends the program where it finds no memory: what it needs, up to 9 numbers for each vertex and each
/// end of an edge and some 50 KB, is asked for before, and given back.
/// @throws std::bad_alloc
void ask_for_memory(std::size_t vertices_and_ends) {
  std::vector<idx_t> room(10 * vertices_and_ends + 20'000);
  const volatile idx_t* const used = room.data();  // lest the compiler leaves it out
  static_cast<void>(*used);
}

}  // namespace

std::vector<Graph::Index> nested_dissection(const Graph& graph) {
  // METIS takes its own integers, and pointers to what it does not change.
  std::vector<idx_t> first(graph.first.begin(), graph.first.end()), to(graph.to.begin(), graph.to.end()),
      order(graph.first.size() - 1), place(order.size());
  ask_for_memory(first.size() + to.size());
  idx_t options[METIS_NOPTIONS], top = 0;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_COMPRESS] = 0;  // vertices of one pattern have been joined
  const OwnRandomNumbers random;
  // The entry for ParMETIS, which is METIS_NodeND() but that it leaves the handlers of SIGTERM and SIGABRT
  // alone. With one process it has one separator to tell the size of. Without weights: where one vertex
  // outweighs the others it goes down until it has no stack.
  const int end = METIS_NodeNDP(graph.size(), first.data(), to.data(), nullptr, 1, options, order.data(),
                                place.data(), &top);
  if (end != METIS_OK) return {};
  return {order.begin(), order.end()};
}
#else
std::vector<Graph::Index> nested_dissection(const Graph&) { return {}; }
#endif

/// Measured on bodies of 1000 to 50,000 unknowns: 0.4 us for each vertex and each end of an edge, which is
/// the time of 10^4 operations in panels.
double dissection_work(const Graph& graph) {
  return 1e4 * static_cast<double>(graph.first.size() - 1 + graph.to.size());
}

}  // namespace hmax
