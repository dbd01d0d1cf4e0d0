#include "dem/breaklines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {
namespace {

struct Place {
  double u, v;
};

double cross(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

/// On which side of the line from a to b a place lies: 1 or -1. Lines count as shifted a little to
/// the east, and much less to the south, so that no place lies on one.
int side_of_line(Place a, Place b, Place p) {
  const double area = cross(b.u - a.u, b.v - a.v, p.u - a.u, p.v - a.v);
  if (area != 0) return area > 0 ? 1 : -1;
  if (b.v != a.v) return b.v > a.v ? 1 : -1;
  return b.u > a.u ? -1 : 1;
}

/// On which side of the way from c to p an end of a line lies, shifted as above.
int side_of_way(Place c, Place p, Place end) {
  const double area = cross(p.u - c.u, p.v - c.v, end.u - c.u, end.v - c.v);
  if (area != 0) return area > 0 ? 1 : -1;
  if (p.v != c.v) return p.v > c.v ? -1 : 1;
  return p.u > c.u ? 1 : -1;
}

/// Calls each(i, at) for the whole numbers i in [0, n) that a segment passes between its ends, and
/// where it is on the other axis.
template <class Each>
void for_crossings(double from, double to, double other_from, double other_to, int n,
                   const Each& each) {
  const double low = std::max(std::ceil(std::min(from, to)), 0.0);
  const double high = std::min(std::floor(std::max(from, to)), n - 1.0);
  for (double i = low; i <= high; ++i)
    if ((from >= i) != (to >= i))
      each(int(i), other_from + (i - from) * (other_to - other_from) / (to - from));
}

}  // namespace

Breaklines::Breaklines(const std::vector<Breakline>& lines, Size size)
    : breaks_(size), touched_(size) {
  for (const Breakline& line : lines) {
    if (line.col.size() != line.row.size())
      throw std::invalid_argument(
          fmt::format("a breakline has {} columns and {} rows", line.col.size(), line.row.size()));
    const auto finite = [](double v) { return std::isfinite(v); };
    if (!std::ranges::all_of(line.col, finite) || !std::ranges::all_of(line.row, finite))
      throw std::invalid_argument("a breakline has a place that is no finite number");
    for (std::size_t i = 1; i < line.col.size(); ++i)
      add({line.col[i - 1], line.row[i - 1], line.col[i], line.row[i]});
  }
  std::ranges::sort(in_cell_);
}

void Breaklines::add(const Segment& s) {
  const Size size = breaks_.size();
  // Rows that it crosses break edges to the east; columns, edges to the south.
  for_crossings(s.v0, s.v1, s.u0, s.u1, size.rows, [&](int row, double at) {
    if (at >= 0 && at < size.cols - 1) breaks_(int(at), row) |= break_east;
  });
  // Shifted east, a line that goes down that way passes a centre on its north.
  const bool goes_down = (s.v1 > s.v0) == (s.u1 > s.u0) && s.v1 != s.v0;
  for_crossings(s.u0, s.u1, s.v0, s.v1, size.cols, [&](int col, double at) {
    const double row = goes_down ? std::ceil(at) - 1 : std::floor(at);
    if (row >= 0 && row < size.rows - 1) breaks_(col, int(row)) |= break_south;
  });

  // The cells that it passes through, row by row.
  const auto number = std::uint32_t(segments_.size());
  segments_.push_back(s);
  const double first = std::max(std::floor(std::min(s.v0, s.v1) + 0.5), 0.0);
  const double last = std::min(std::floor(std::max(s.v0, s.v1) + 0.5), size.rows - 1.0);
  for (double row = first; row <= last; ++row) {
    const auto u_at = [&](double v) {
      if (s.v0 == s.v1) return s.u0;
      const double t = std::clamp((v - s.v0) / (s.v1 - s.v0), 0.0, 1.0);
      return s.u0 + t * (s.u1 - s.u0);
    };
    const double a = u_at(row - 0.5), b = s.v0 == s.v1 ? s.u1 : u_at(row + 0.5);
    const double from = std::max(std::floor(std::min(a, b) + 0.5), 0.0);
    const double to = std::min(std::floor(std::max(a, b) + 0.5), size.cols - 1.0);
    for (double col = from; col <= to; ++col) {
      touched_(int(col), int(row)) = 1;
      in_cell_.emplace_back(std::uint64_t(row) * std::uint64_t(size.cols) + std::uint64_t(col),
                            number);
    }
  }
}

bool Breaklines::between(int col, int row, double dx, double dy) const {
  if (!touched_.contains(col, row) || !touched_(col, row)) return false;
  const Place centre{double(col), double(row)}, place{col + dx, row + dy};
  const auto cell = std::uint64_t(row) * std::uint64_t(touched_.cols()) + std::uint64_t(col);
  bool crossed = false;  // twice is not at all
  for (auto at = std::ranges::lower_bound(in_cell_, std::pair(cell, std::uint32_t(0)));
       at != in_cell_.end() && at->first == cell; ++at) {
    const Segment& s = segments_[at->second];
    const Place a{s.u0, s.v0}, b{s.u1, s.v1};
    if (side_of_line(a, b, centre) != side_of_line(a, b, place) &&
        side_of_way(centre, place, a) != side_of_way(centre, place, b))
      crossed = !crossed;
  }
  return crossed;
}

bool is_broken(const Mask& breaks, int col, int row, int width, int height) {
  if (breaks.empty()) return false;
  for (int y = row; y < row + height; ++y)
    for (int x = col; x < col + width; ++x) {
      const std::uint8_t here = breaks(x, y);
      if ((x + 1 < col + width && (here & break_east)) ||
          (y + 1 < row + height && (here & break_south)))
        return true;
    }
  return false;
}

Mask cells_closed_off(const Mask& known, const Mask& breaks) {
  const Size size = known.size();
  if (breaks.empty()) return Mask(size);
  // What known cells reach over unbroken edges is not closed off.
  Mask closed(size, 1);
  std::vector<Cell> waiting;
  const auto reach = [&](int col, int row) {
    if (!closed(col, row)) return;
    closed(col, row) = 0;
    waiting.push_back({col, row});
  };
  const auto open = [&](int col, int row, std::uint8_t edge) { return !(breaks(col, row) & edge); };
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      if (!known(col, row)) continue;
      reach(col, row);
      while (!waiting.empty()) {
        const auto [x, y] = waiting.back();
        waiting.pop_back();
        if (x + 1 < size.cols && open(x, y, break_east)) reach(x + 1, y);
        if (x > 0 && open(x - 1, y, break_east)) reach(x - 1, y);
        if (y + 1 < size.rows && open(x, y, break_south)) reach(x, y + 1);
        if (y > 0 && open(x, y - 1, break_south)) reach(x, y - 1);
      }
    }
  return closed;
}

}  // namespace dem
