#pragma once
// A fast priority queue of cells, and the filling of depressions with it. Private to the library.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "dem/raster.h"
#include "dem/run.h"

namespace dem::synthesis {

/// Cells by key, lowest first, equal keys by index. Keys between `low` and `high` cost O(1), as
/// long as none is pushed that is lower than the last one popped: only the bucket in use is sorted.
class CellQueue {
 public:
  struct Item {
    float key;
    std::int32_t index;
    bool operator>(const Item& other) const {
      return key != other.key ? key > other.key : index > other.index;
    }
  };

  CellQueue(float low, float high, std::size_t buckets)
      : low_(low),
        per_bucket_(high > low ? float(buckets - 1) / (high - low) : 0),
        buckets_(buckets) {}

  void push(float key, std::int32_t index) {
    const std::size_t b = bucket(key);
    if (b > now_) {
      buckets_[b].push_back({key, index});
    } else {
      heap_.push_back({key, index});
      std::ranges::push_heap(heap_, std::greater<>());
    }
    ++size_;
  }

  bool empty() const { return size_ == 0; }

  Item pop() {
    while (heap_.empty()) {
      heap_.swap(buckets_[++now_]);
      std::ranges::make_heap(heap_, std::greater<>());
    }
    std::ranges::pop_heap(heap_, std::greater<>());
    const Item item = heap_.back();
    heap_.pop_back();
    --size_;
    return item;
  }

 private:
  std::size_t bucket(float key) const {
    const float b = (key - low_) * per_bucket_;
    return b <= 0 ? 0 : std::min(std::size_t(b), buckets_.size() - 1);
  }

  float low_, per_bucket_;
  std::size_t now_ = 0, size_ = 0;
  std::vector<Item> heap_;  // the bucket in use
  std::vector<std::vector<Item>> buckets_;
};

/// Raises cells until from each a path leads to an outlet on which every step (to one of the eight
/// neighbours) falls, by `step` at least as far as float32 can tell, always by something; the
/// least that does it. Outlets are the cells where `done` is set; they stay as they are.
/// Method: priority flood. Cells with no way to an outlet stay as they are.
inline void fill_depressions(Raster<float>& z, Mask done, float step, const Run& run) {
  const int cols = z.cols(), rows = z.rows();
  const auto [low, high] = std::ranges::minmax(z.cells());
  CellQueue queue(low, high, std::max<std::size_t>(2, z.cells().size() / 64));
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      if (done(col, row)) queue.push(z(col, row), row * cols + col);
  for (std::size_t n = 0; !queue.empty(); ++n) {
    if (n % 262144 == 0) run.report(double(n) / double(z.cells().size()), "drainage");
    const auto [height, index] = queue.pop();
    const int col = index % cols, row = index / cols;
    const float least =
        std::max(height + step, std::nextafter(height, std::numeric_limits<float>::infinity()));
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
      for (int c = std::max(0, col - 1); c <= std::min(cols - 1, col + 1); ++c) {
        if (done(c, r)) continue;
        done(c, r) = 1;
        z(c, r) = std::max(z(c, r), least);
        queue.push(z(c, r), r * cols + c);
      }
  }
}

}  // namespace dem::synthesis
