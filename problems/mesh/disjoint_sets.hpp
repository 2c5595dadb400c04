/// Points or tetrahedra that hang together.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/at.hpp"
#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Sets that are joined one pair after the other; each is known by its least member.
class DisjointSets {
 public:
  using Index = TetMesh::Index;

  explicit DisjointSets(Eigen::Index count) : parent_(at(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index root(Index a) {
    while (parent_[at(a)] != a) a = parent_[at(a)] = parent_[at(parent_[at(a)])];
    return a;
  }
  /// @returns  whether they were apart
  bool join(Index a, Index b) {
    a = root(a);
    b = root(b);
    parent_[at(std::max(a, b))] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace hmax
