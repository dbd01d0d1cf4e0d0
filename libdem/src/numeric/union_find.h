#pragma once
// Things that are joined two by two, and the group that each is in. Private to the library.

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace dem::numeric {

/// A forest over 0, 1, 2, ...; each group is named by its smallest member, its root.
template <class Index = std::size_t>
class UnionFind {
 public:
  explicit UnionFind(std::size_t size = 0) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }

  /// Adds members, each a group of its own, until there are `size`.
  void grow(std::size_t size) {
    for (std::size_t i = parent_.size(); i < size; ++i) parent_.push_back(Index(i));
  }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(Index a, Index b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace dem::numeric
