#pragma once
// Rasters: the values that every algorithm takes and returns. Standard library only.

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <span>
#include <vector>

namespace dem {

/// Memory for `bytes` bytes of cells. Large blocks use large pages of the system, which are ready
/// sooner. Throws std::bad_alloc.
void* allocate_cells(std::size_t bytes);
void free_cells(void* cells) noexcept;

/// The allocator of rasters.
template <class T>
struct CellAllocator {
  using value_type = T;

  CellAllocator() = default;
  template <class U>
  CellAllocator(const CellAllocator<U>&) {}

  T* allocate(std::size_t n) {
    if (n > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(T))
      throw std::bad_array_new_length();
    return static_cast<T*>(allocate_cells(n * sizeof(T)));
  }
  void deallocate(T* cells, std::size_t) noexcept { free_cells(cells); }
  template <class U>
  void construct(U* cell) {
    ::new (static_cast<void*>(cell)) U;  // a number without a value stays unset
  }

  bool operator==(const CellAllocator&) const = default;
};

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

/// A rectangle of cells.
struct Box {
  int col = 0, row = 0, cols = 0, rows = 0;

  Size size() const { return {cols, rows}; }
  std::size_t cells() const { return size().cells(); }
  bool contains(const Box& b) const {
    return b.col >= col && b.row >= row && b.col + b.cols <= col + cols &&
           b.row + b.rows <= row + rows;
  }
  bool operator==(const Box&) const = default;
};

/// A rectangle of values, row by row, row 0 in the north. It owns its cells.
/// Cells are named (col, row). A Raster<float> returned by a reconstruction has no holes.
template <class T>
class Raster {
 public:
  Raster() = default;
  explicit Raster(Size size, T value = {}) : size_(size), cells_(size.cells(), value) {}

  /// A raster whose cells are all written before they are read: no time is spent on zeros.
  static Raster unset(Size size) {
    Raster raster;
    raster.size_ = size;
    raster.cells_.resize(size.cells());
    return raster;
  }

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
  std::vector<T, CellAllocator<T>> cells_;
};

/// One byte a cell: 1 = known (measured, or chosen), 0 = unknown. The same polarity everywhere.
using Mask = Raster<std::uint8_t>;

/// The number of cells that are set in the mask.
inline std::size_t count(const Mask& mask) {
  std::size_t n = 0;
  for (auto m : mask.cells()) n += m != 0;
  return n;
}

/// The cells of a box, which lies within the raster.
template <class T>
Raster<T> crop(const Raster<T>& raster, const Box& box) {
  auto part = Raster<T>::unset(box.size());
  for (int row = 0; row < box.rows; ++row) {
    const auto cells =
        raster.row(box.row + row).subspan(std::size_t(box.col), std::size_t(box.cols));
    std::ranges::copy(cells, part.row(row).begin());
  }
  return part;
}

}  // namespace dem
