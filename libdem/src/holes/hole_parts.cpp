// Holes of a raster from its parts. A hole that reaches several parts is scanned anew, from its
// cells and its rim alone, by the scanner that would have found it in the whole raster: the same
// sums in the same order.

#include "dem/hole_parts.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "numeric/union_find.h"

namespace dem {
using namespace numeric;
namespace {

bool overlap(const Box& a, const Box& b) {
  return a.col < b.col + b.cols && b.col < a.col + a.cols && a.row < b.row + b.rows &&
         b.row < a.row + a.rows;
}

std::vector<Spacing> rows_of(const std::vector<Spacing>& spacing, const Box& box) {
  return {spacing.begin() + box.row, spacing.begin() + box.row + box.rows};
}

void move_hole(Hole& hole, int cols, int rows) {
  hole.box.col += cols;
  hole.box.row += rows;
  hole.first_col += cols;
}

/// Appends the run cut to the part, in cells of the raster.
void add_cut(const CellRun& run, const Box& ring, const Box& part, std::vector<CellRun>& runs) {
  const int row = run.row + ring.row;
  const int begin = std::max(run.begin + ring.col, part.col);
  const int end = std::min(run.end + ring.col, part.col + part.cols);
  if (row >= part.row && row < part.row + part.rows && begin < end)
    runs.push_back({row, begin, end});
}

/// Known cells beside the runs (in cells of the raster), each once.
std::vector<RimCell> rim_of(const std::vector<CellRun>& runs, const Dem& dem, const Box& ring) {
  std::vector<RimCell> rim;
  if (runs.empty()) return rim;
  Mask seen(dem.size());
  for (const CellRun& run : runs)
    for (int row = run.row - 1; row <= run.row + 1; ++row)
      for (int col = run.begin - 1; col <= run.end; ++col) {
        const int x = col - ring.col, y = row - ring.row;
        if (!dem.known.contains(x, y) || !dem.known(x, y) || seen(x, y)) continue;
        seen(x, y) = 1;
        rim.push_back({row, col, dem.z(x, y)});
      }
  return rim;
}

bool row_order(const CellRun& a, const CellRun& b) {
  return a.row != b.row ? a.row < b.row : a.begin < b.begin;
}

/// All runs in order, those that meet at the edge of two parts made one.
std::vector<CellRun> joined_runs(const std::vector<HolePart>& parts) {
  std::vector<CellRun> all, joined;
  for (const HolePart& part : parts) all.insert(all.end(), part.runs.begin(), part.runs.end());
  std::ranges::sort(all, row_order);
  for (const CellRun& run : all)
    if (!joined.empty() && joined.back().row == run.row && joined.back().end >= run.begin)
      joined.back().end = std::max(joined.back().end, run.end);
    else
      joined.push_back(run);
  return joined;
}

/// The runs of each hole: those that touch from row to row, corners included.
std::vector<std::vector<CellRun>> connected(const std::vector<CellRun>& runs) {
  UnionFind holes(runs.size());
  for (std::size_t above = 0, i = 0; i < runs.size(); ++i) {
    while (runs[above].row < runs[i].row - 1 ||
           (runs[above].row == runs[i].row - 1 && runs[above].end < runs[i].begin))
      ++above;
    for (std::size_t a = above; runs[a].row == runs[i].row - 1 && runs[a].begin <= runs[i].end; ++a)
      holes.join(a, i);
  }
  std::vector<std::vector<CellRun>> groups;
  std::vector<std::size_t> group_of(runs.size(), runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::size_t& group = group_of[holes.root(i)];
    if (group == runs.size()) {
      group = groups.size();
      groups.emplace_back();
    }
    groups[group].push_back(runs[i]);
  }
  return groups;
}

Box box_of(const std::vector<CellRun>& runs) {
  int left = runs[0].begin, right = runs[0].end;
  for (const CellRun& run : runs) {
    left = std::min(left, run.begin);
    right = std::max(right, run.end);
  }
  return {left, runs.front().row, right - left, runs.back().row - runs.front().row + 1};
}

bool place_order(const RimCell& a, const RimCell& b) {
  return a.row != b.row ? a.row < b.row : a.col < b.col;
}

/// A hole of these runs, in a raster where all else is known.
Hole scan_alone(const std::vector<CellRun>& runs, std::span<const RimCell> rim, Size raster,
                const std::vector<Spacing>& spacing) {
  const Box ring = with_ring(box_of(runs), raster);
  HoleScanner scanner(ring.cols, rows_of(spacing, ring));
  std::vector<std::uint8_t> known(std::size_t(ring.cols), 1);
  std::vector<float> z(std::size_t(ring.cols));
  auto run = runs.begin();
  for (int row = ring.row; row < ring.row + ring.rows; ++row) {
    const auto first = run;
    for (; run != runs.end() && run->row == row; ++run)
      std::fill(known.begin() + (run->begin - ring.col), known.begin() + (run->end - ring.col),
                std::uint8_t{0});
    auto cell = std::ranges::lower_bound(rim, RimCell{row, ring.col}, place_order);
    for (; cell != rim.end() && cell->row == row && cell->col < ring.col + ring.cols; ++cell)
      z[std::size_t(cell->col - ring.col)] = cell->z;
    scanner.add_row(known, z);
    for (auto done = first; done != run; ++done)
      std::fill(known.begin() + (done->begin - ring.col), known.begin() + (done->end - ring.col),
                std::uint8_t{1});
  }
  std::vector<Hole> holes = scanner.finish();
  if (holes.size() != 1) throw std::logic_error("parts of a raster do not fit together");
  move_hole(holes[0], ring.col, ring.row);
  return holes[0];
}

}  // namespace

Box with_ring(const Box& box, Size raster) {
  const int col = std::max(0, box.col - 1), row = std::max(0, box.row - 1);
  return {col, row, std::min(raster.cols, box.col + box.cols + 1) - col,
          std::min(raster.rows, box.row + box.rows + 1) - row};
}

HolePart scan_part(const Dem& dem, const Box& part, Size raster,
                   const std::vector<Spacing>& spacing) {
  const Box ring = with_ring(part, raster);
  if (dem.size() != ring.size() || spacing.size() != std::size_t(raster.rows))
    throw std::logic_error("a part comes with the ring around it and all rows' spacing");
  HolePart out;
  std::vector<FirstCell> shared;
  for (Hole& hole : find_holes(dem, rows_of(spacing, ring))) {
    const FirstCell first{hole.first_col, hole.box.row};
    move_hole(hole, ring.col, ring.row);
    if (part.contains(hole.box))
      out.holes.push_back(hole);
    else if (overlap(part, hole.box))
      shared.push_back(first);
  }
  for (const auto& cells : cells_of_holes(dem.known, shared))
    for (const CellRun& run : cells) add_cut(run, ring, part, out.runs);
  std::ranges::sort(out.runs, row_order);
  out.rim = rim_of(out.runs, dem, ring);

  for (int row = part.row; row < part.row + part.rows; ++row) {
    const auto known = dem.known.row(row - ring.row)
                           .subspan(std::size_t(part.col - ring.col), std::size_t(part.cols));
    out.known_cells += std::size_t(std::ranges::count_if(known, [](auto k) { return k != 0; }));
  }
  return out;
}

std::vector<Hole> join_parts(const std::vector<HolePart>& parts, Size raster,
                             const std::vector<Spacing>& spacing) {
  std::vector<Hole> holes;
  std::vector<RimCell> rim;
  for (const HolePart& part : parts) {
    holes.insert(holes.end(), part.holes.begin(), part.holes.end());
    rim.insert(rim.end(), part.rim.begin(), part.rim.end());
  }
  std::ranges::sort(rim, place_order);
  for (const auto& runs : connected(joined_runs(parts)))
    holes.push_back(scan_alone(runs, rim, raster, spacing));
  std::ranges::sort(holes, [](const Hole& a, const Hole& b) {
    return a.box.row != b.box.row ? a.box.row < b.box.row : a.first_col < b.first_col;
  });
  return holes;
}

}  // namespace dem
