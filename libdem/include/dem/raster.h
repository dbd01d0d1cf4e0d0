#pragma once
// Rasters: the values that every algorithm takes and returns. Standard library only.

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dem {

/// Width and height of a raster in cells.
struct Size {
  int cols = 0;
  int rows = 0;

  std::size_t cells() const { return std::size_t(cols) * std::size_t(rows); }
  bool operator==(const Size&) const = default;
};

/// The place of a cell.
struct Cell {
  int col = 0;
  int row = 0;

  bool operator==(const Cell&) const = default;
};

/// A rectangle of values, row by row, row 0 in the north. It owns its cells.
/// Cells are named (col, row). A Raster<float> returned by a reconstruction has no holes.
template <class T>
class Raster {
 public:
  Raster() = default;
  explicit Raster(Size size, T value = {}) : size_(size), cells_(size.cells(), value) {}

  Size size() const { return size_; }
  int cols() const { return size_.cols; }
  int rows() const { return size_.rows; }
  bool empty() const { return cells_.empty(); }
  bool contains(int col, int row) const {
    return col >= 0 && row >= 0 && col < size_.cols && row < size_.rows;
  }

  T& operator()(int col, int row) { return cells_[index(col, row)]; }
  const T& operator()(int col, int row) const { return cells_[index(col, row)]; }

  // Views of the cells. They live no longer than the raster, so a temporary has none.
  std::span<T> row(int r) & { return {cells_.data() + index(0, r), std::size_t(size_.cols)}; }
  std::span<const T> row(int r) const& {
    return {cells_.data() + index(0, r), std::size_t(size_.cols)};
  }
  std::span<T> row(int r) && = delete;
  std::span<T> cells() & { return cells_; }
  std::span<const T> cells() const& { return cells_; }
  std::span<T> cells() && = delete;

  bool operator==(const Raster&) const = default;

 private:
  std::size_t index(int col, int row) const {
    assert(contains(col, row));
    return std::size_t(row) * std::size_t(size_.cols) + std::size_t(col);
  }

  Size size_;
  std::vector<T> cells_;
};

/// One byte a cell: 1 = known (measured, or chosen), 0 = unknown. The same polarity everywhere.
using Mask = Raster<std::uint8_t>;

/// How many cells of the mask are set.
inline std::size_t count(const Mask& mask) {
  std::size_t n = 0;
  for (auto m : mask.cells()) n += m != 0;
  return n;
}

}  // namespace dem
