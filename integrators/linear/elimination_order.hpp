/// Orders of elimination of a sparse symmetric matrix, by its graph.
#pragma once

#include <span>
#include <vector>

namespace hmax {

/// An undirected graph: the neighbours of v, without v, are to[first[v]], ..., to[first[v + 1] - 1]. Each
/// edge is stored at both ends.
struct Graph {
  using Index = int;
  std::vector<Index> first{0}, to;

  [[nodiscard]] Index size() const { return static_cast<Index>(first.size()) - 1; }  ///< vertices
  [[nodiscard]] std::span<const Index> of(Index v) const {
    return std::span(to).subspan(first[v], first[v + 1] - first[v]);
  }
};

/// The vertices in an order of approximate minimum degree, which keeps the fill of L small: vertex order[k]
/// is eliminated as the k-th, shape (n).
/// @source [davis2016survey] 7
std::vector<Graph::Index> minimum_degree(const Graph& graph);

/// The same by nested dissection: a small separator splits the graph in halves, which are eliminated before
/// it and split in turn. The same graph gives the same order in every thread and every call; no thread
/// of another library may use rand() meanwhile.
/// @returns     empty where hmax was built without METIS
/// @throws std::bad_alloc
/// @source [karypis1998fast]
std::vector<Graph::Index> nested_dissection(const Graph& graph);

/// Operations of a factorisation that take as long as nested_dissection(): an order that needs no more of
/// them is good enough.
double dissection_work(const Graph& graph);

}  // namespace hmax
