#pragma once
// Working arrays of the spline's solver: rows with a margin, so that a stencil needs no test for
// the rim. Private to the library.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "dem/raster.h"
#include "numeric/simd.h"

namespace dem::spline {

/// A raster whose rows have at least eight cells of margin on either side. The margin stays 0.
template <class T>
class Grid {
 public:
  static constexpr int margin = 8;
  static constexpr int stride_for(int cols) { return (cols + 15) / 16 * 16 + 2 * margin; }

  Grid() = default;
  explicit Grid(Size size)
      : size_(size),
        stride_(std::size_t(stride_for(size.cols))),
        cells_(stride_ * std::size_t(size.rows)) {}

  Size size() const { return size_; }
  bool empty() const { return cells_.empty(); }
  T* row(int y) { return cells_.data() + std::size_t(y) * stride_ + margin; }
  const T* row(int y) const { return cells_.data() + std::size_t(y) * stride_ + margin; }

 private:
  Size size_;
  std::size_t stride_ = 0;
  std::vector<T> cells_;
};

/// Columns [begin, end) of one row.
struct Span {
  int begin, end;
};

/// The parts of each row that a solve works on. They cover all unknown cells, and gaps too short to
/// be worth skipping.
class Spans {
 public:
  /// Adds the next row. `parts` are in order; close ones are merged, rims are widened.
  void add_row(std::span<const Span> parts, int cols) {
    const std::size_t first = spans_.size();
    for (const Span part : parts) {
      Span wide{part.begin / 8 * 8, std::min(cols, (part.end + 7) / 8 * 8)};
      if (wide.end > cols - 8) wide.end = cols;
      if (spans_.size() > first && wide.begin - spans_.back().end < 24)
        spans_.back().end = std::max(spans_.back().end, wide.end);
      else
        spans_.push_back(wide);
    }
    first_.push_back(spans_.size());
  }

  std::span<const Span> row(int y) const {
    return {spans_.data() + first_[std::size_t(y)], spans_.data() + first_[std::size_t(y) + 1]};
  }
  int rows() const { return int(first_.size()) - 1; }

 private:
  std::vector<Span> spans_;
  std::vector<std::size_t> first_{0};
};

/// Writes 0 to every cell of a row that lies in no span.
template <class T>
void clear_gaps(T* row, std::span<const Span> spans, int cols) {
  int done = 0;
  for (const Span s : spans) {
    std::fill(row + done, row + s.begin, T(0));
    done = s.end;
  }
  std::fill(row + done, row + cols, T(0));
}

}  // namespace dem::spline
