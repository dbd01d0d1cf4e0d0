#pragma once
// Lines across which a surface may jump: cliffs, dams, quays, faults.

#include <cstdint>
#include <utility>
#include <vector>

#include "dem/dem.h"

namespace dem {

/// A line in columns and rows of a lattice, whose cell centres are whole numbers. The first and the
/// last point of a ring are the same.
struct Breakline {
  std::vector<double> col, row;
};

/// Breaklines on a lattice.
class Breaklines {
 public:
  Breaklines() = default;

  /// Throws std::invalid_argument for a line that is not finite, or whose columns and rows differ
  /// in number.
  Breaklines(const std::vector<Breakline>& lines, Size size);

  bool empty() const { return segments_.empty(); }

  /// Where lines pass between neighbouring cells, in the form of Dem::breaks.
  /// Method: a line breaks the edges between cell centres that it crosses. A centre exactly on a
  ///         line counts as west of it, or as north of it where the line runs along a row. A line
  ///         that encloses an area therefore leaves no way out over unbroken edges.
  const Mask& breaks() const { return breaks_; }

  /// Whether a line passes between the centre of a cell and the point (dx, dy) from the centre.
  bool between(int col, int row, double dx, double dy) const;

 private:
  struct Segment {
    double u0, v0, u1, v1;
  };
  void add(const Segment& segment);

  Mask breaks_;
  Mask touched_;  ///< cells that a segment passes through
  std::vector<Segment> segments_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> in_cell_;  ///< cell, segment; sorted
};

/// Whether an edge between two cells of the block [col, col + width) x [row, row + height) is
/// broken.
/// `breaks` may be empty.
bool is_broken(const Mask& breaks, int col, int row, int width, int height);

/// The cells that are connected to no known cell, because broken edges enclose them. Without breaks
/// there are none.
Mask cells_closed_off(const Mask& known, const Mask& breaks);

}  // namespace dem
