#include "dem/holes.h"

#include <algorithm>
#include <vector>

#include "numeric/union_find.h"

namespace dem {
using namespace numeric;
namespace {

/// Unknown cells [begin, end) of one row.
struct VoidRun {
  int row, begin, end;
};

struct Voids {
  std::vector<VoidRun> runs;
  std::vector<std::size_t> root;     // of each run; a void is named by its first run
  std::vector<std::size_t> cells;    // of each void, at its root
  std::vector<std::uint8_t> on_rim;  // of each void, at its root
};

void add_runs_of_row(const Mask& known, int row, std::vector<VoidRun>& runs) {
  const auto cells = known.row(row);
  const auto is_known = [](auto k) { return k != 0; };
  for (auto end = cells.begin();;) {
    const auto begin = std::find_if_not(end, cells.end(), is_known);
    if (begin == cells.end()) return;
    end = std::find_if(begin, cells.end(), is_known);
    runs.push_back({row, int(begin - cells.begin()), int(end - cells.begin())});
  }
}

/// Two runs of neighbouring rows touch, also across a corner:
///   above   . # # .
///   below   # . . #     each of these two touches
bool touch(const VoidRun& a, const VoidRun& b) { return a.begin <= b.end && b.begin <= a.end; }

Voids find_voids(const Mask& known) {
  Voids v;
  UnionFind voids;
  std::size_t above = 0;  // first run of the row above
  for (int row = 0; row < known.rows(); ++row) {
    const std::size_t here = v.runs.size();
    add_runs_of_row(known, row, v.runs);
    voids.grow(v.runs.size());

    // Both rows are sorted: step on in the one whose run ends first.
    for (std::size_t a = above, b = here; a < here && b < v.runs.size();) {
      if (touch(v.runs[a], v.runs[b])) voids.join(a, b);
      v.runs[a].end < v.runs[b].end ? ++a : ++b;
    }
    above = here;
  }

  v.root.resize(v.runs.size());
  v.cells.resize(v.runs.size());
  v.on_rim.resize(v.runs.size());
  for (std::size_t i = 0; i < v.runs.size(); ++i) {
    const auto& run = v.runs[i];
    const std::size_t root = v.root[i] = voids.root(i);
    v.cells[root] += std::size_t(run.end - run.begin);
    if (run.row == 0 || run.row == known.rows() - 1 || run.begin == 0 || run.end == known.cols())
      v.on_rim[root] = 1;
  }
  return v;
}

}  // namespace

VoidSummary void_summary(const Mask& known) {
  const Voids v = find_voids(known);
  VoidSummary sum;
  for (std::size_t i = 0; i < v.runs.size(); ++i) {
    if (v.root[i] != i) continue;
    sum.cells += v.cells[i];
    sum.voids += 1;
    sum.largest = std::max(sum.largest, v.cells[i]);
    sum.border_voids += v.on_rim[i];
    if (v.on_rim[i]) sum.border_cells += v.cells[i];
  }
  return sum;
}

Mask inner_voids(const Mask& known) {
  const Voids v = find_voids(known);
  Mask inner(known.size());
  for (std::size_t i = 0; i < v.runs.size(); ++i) {
    if (v.on_rim[v.root[i]]) continue;
    const auto row = inner.row(v.runs[i].row);
    std::fill(row.begin() + v.runs[i].begin, row.begin() + v.runs[i].end, std::uint8_t{1});
  }
  return inner;
}

}  // namespace dem
