// The inventory of holes, from rows that pass one by one.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/holes.h"
#include "numeric/distance.h"
#include "numeric/union_find.h"

namespace dem {
using namespace numeric;
namespace {

// ---- Greatest distance to data

constexpr double infinite = Envelope::infinite;
constexpr std::size_t most_distance_cells = std::size_t{1} << 24;

/// The greatest distance of a hole's cells to a cell outside it, within the raster. The cell
/// nearest outside is known: any other would belong to the hole.
/// Boxes above the limit are looked at in squares of k x k cells, outside where one cell is.
double greatest_distance(const std::vector<CellRun>& runs, const Box& box, int raster_cols,
                         int raster_rows, Spacing spacing) {
  // A ring of cells around the box, where the raster has them.
  const int left = std::max(0, box.col - 1), top = std::max(0, box.row - 1);
  const int right = std::min(raster_cols, box.col + box.cols + 1);
  const int bottom = std::min(raster_rows, box.row + box.rows + 1);
  int k = 1;
  while (Size{(right - left) / k + 1, (bottom - top) / k + 1}.cells() > most_distance_cells) ++k;
  const Size size{(right - left + k - 1) / k, (bottom - top + k - 1) / k};

  Raster<std::uint16_t> inside(size);  // cells of the hole in each square, at most k * k
  for (const CellRun& run : runs)
    for (int col = run.begin; col < run.end; ++col) ++inside((col - left) / k, (run.row - top) / k);
  const auto cells_in = [&](int col, int row) {
    return std::min(k, right - left - col * k) * std::min(k, bottom - top - row * k);
  };

  // Down and up each column to the nearest square that is not all hole; then along the rows.
  Raster<float> d2(size);
  const double dy = spacing.dy_m * k, dx = spacing.dx_m * k;
  std::vector<double> line(std::size_t(size.rows));
  Envelope envelope;
  for (int col = 0; col < size.cols; ++col) {
    double since = infinite;
    for (int row = 0; row < size.rows; ++row) {
      since = inside(col, row) < cells_in(col, row) ? 0 : since + dy;
      line[std::size_t(row)] = since;
    }
    since = infinite;
    for (int row = size.rows; row-- > 0;) {
      since = inside(col, row) < cells_in(col, row) ? 0 : since + dy;
      const double d = std::min(since, line[std::size_t(row)]);
      d2(col, row) = float(d * d);
    }
  }
  double greatest = 0;
  line.resize(std::size_t(size.cols));
  for (int row = 0; row < size.rows; ++row) {
    for (int col = 0; col < size.cols; ++col) {
      const double d = d2(col, row);
      line[std::size_t(col)] = std::isinf(d) ? infinite : d;
    }
    envelope.apply(line, dx * dx);
    for (const double d : line)
      if (d != infinite) greatest = std::max(greatest, d);
  }
  return std::sqrt(greatest);
}

// ---- Open holes

struct OpenHole {
  Hole hole;
  std::vector<CellRun> runs;
  double rim_sum = 0;
  std::size_t rim_count = 0;

  void add_rim(double z) {
    hole.rim_low_m = rim_count ? std::min(hole.rim_low_m, z) : z;
    hole.rim_high_m = rim_count ? std::max(hole.rim_high_m, z) : z;
    rim_sum += z;
    ++rim_count;
  }
};

/// Puts the smaller one into the larger one.
void merge(OpenHole& into, OpenHole& from) {
  if (into.runs.size() < from.runs.size()) std::swap(into, from);
  Hole& a = into.hole;
  const Hole& b = from.hole;
  if (b.box.row < a.box.row || (b.box.row == a.box.row && b.first_col < a.first_col))
    a.first_col = b.first_col;
  const int right = std::max(a.box.col + a.box.cols, b.box.col + b.box.cols);
  const int bottom = std::max(a.box.row + a.box.rows, b.box.row + b.box.rows);
  a.box.col = std::min(a.box.col, b.box.col);
  a.box.row = std::min(a.box.row, b.box.row);
  a.box.cols = right - a.box.col;
  a.box.rows = bottom - a.box.row;
  a.cells += b.cells;
  a.marked_cells += b.marked_cells;
  a.area_m2 += b.area_m2;
  a.at_border |= b.at_border;
  if (from.rim_count) {
    const bool any = into.rim_count > 0;
    a.rim_low_m = any ? std::min(a.rim_low_m, b.rim_low_m) : b.rim_low_m;
    a.rim_high_m = any ? std::max(a.rim_high_m, b.rim_high_m) : b.rim_high_m;
  }
  into.rim_sum += from.rim_sum;
  into.rim_count += from.rim_count;
  into.runs.insert(into.runs.end(), from.runs.begin(), from.runs.end());
  from = {};
}

/// A run of the latest row, and the number of its hole among the open ones.
struct TipRun {
  int begin, end;
  std::size_t hole;
};

}  // namespace

class HoleScanner::Scan {
 public:
  Scan(int cols, std::vector<Spacing> spacing)
      : cols_(cols), rows_(int(spacing.size())), spacing_(std::move(spacing)) {}

  void add_row(std::span<const std::uint8_t> known, std::span<const float> z,
               std::span<const std::uint8_t> marked) {
    if (int(known.size()) != cols_ || int(z.size()) != cols_ ||
        (!marked.empty() && int(marked.size()) != cols_) || row_ >= rows_)
      throw std::logic_error("a row of another raster");

    // Each run begins a hole; then those that touch runs of the row above join theirs.
    std::vector<TipRun> runs;
    for (auto end = known.begin();;) {
      const auto begin = std::find(end, known.end(), 0);
      if (begin == known.end()) break;
      end = std::find_if(begin, known.end(), [](auto k) { return k != 0; });
      runs.push_back({int(begin - known.begin()), int(end - known.begin()), open_.size()});
      open_.push_back(new_hole(runs.back(), marked));
    }
    UnionFind holes(open_.size());
    for (std::size_t a = 0, b = 0; a < tips_.size() && b < runs.size();) {
      if (tips_[a].begin <= runs[b].end && runs[b].begin <= tips_[a].end) {
        const std::size_t i = holes.root(tips_[a].hole), j = holes.root(runs[b].hole);
        if (i != j) {
          merge(open_[std::min(i, j)], open_[std::max(i, j)]);
          holes.join(i, j);
        }
      }
      tips_[a].end < runs[b].end ? ++a : ++b;
    }

    // The rim: beside the runs, above them, and below those of the row above.
    //     o o o o
    //     o # # o
    //     o o o o
    for (const TipRun& run : runs) {
      OpenHole& hole = open_[holes.root(run.hole)];
      if (run.begin > 0) hole.add_rim(double(z[std::size_t(run.begin) - 1]));
      if (run.end < cols_) hole.add_rim(double(z[std::size_t(run.end)]));
      if (row_ > 0) add_rim(hole, run, known_above_, z_above_);
    }
    for (const TipRun& tip : tips_) add_rim(open_[holes.root(tip.hole)], tip, known, z);

    // What the row did not touch is complete.
    std::vector<std::size_t> number(open_.size(), closed);
    std::vector<OpenHole> still_open;
    for (TipRun& run : runs) {
      const std::size_t root = holes.root(run.hole);
      if (number[root] == closed) {
        number[root] = still_open.size();
        still_open.push_back(std::move(open_[root]));
      }
      run.hole = number[root];
    }
    for (const TipRun& tip : tips_) {
      const std::size_t root = holes.root(tip.hole);
      if (number[root] != closed) continue;
      complete(open_[root]);
      number[root] = 0;
    }
    open_ = std::move(still_open);
    tips_ = std::move(runs);
    known_above_.assign(known.begin(), known.end());
    z_above_.assign(z.begin(), z.end());
    ++row_;
  }

  std::vector<Hole> finish() {
    if (row_ != rows_) throw std::logic_error("rows of the raster are missing");
    for (OpenHole& open : open_) complete(open);
    open_.clear();
    std::ranges::sort(done_, [](const Hole& a, const Hole& b) {
      return a.box.row != b.box.row ? a.box.row < b.box.row : a.first_col < b.first_col;
    });
    return std::move(done_);
  }

 private:
  static constexpr std::size_t closed = std::size_t(-1);

  OpenHole new_hole(const TipRun& run, std::span<const std::uint8_t> marked) const {
    const Spacing s = spacing_[std::size_t(row_)];
    OpenHole open;
    Hole& hole = open.hole;
    hole.box = {run.begin, row_, run.end - run.begin, 1};
    hole.first_col = run.begin;
    hole.cells = std::size_t(run.end - run.begin);
    hole.area_m2 = double(hole.cells) * s.dx_m * s.dy_m;
    hole.at_border = row_ == 0 || row_ == rows_ - 1 || run.begin == 0 || run.end == cols_;
    if (!marked.empty())
      hole.marked_cells = std::size_t(std::count_if(
          marked.begin() + run.begin, marked.begin() + run.end, [](auto m) { return m != 0; }));
    open.runs.push_back({row_, run.begin, run.end});
    return open;
  }

  void add_rim(OpenHole& hole, const TipRun& run, std::span<const std::uint8_t> known,
               std::span<const float> z) const {
    for (int col = std::max(0, run.begin - 1); col < std::min(cols_, run.end + 1); ++col)
      if (known[std::size_t(col)]) hole.add_rim(double(z[std::size_t(col)]));
  }

  void complete(OpenHole& open) {
    Hole& hole = open.hole;
    const int middle = hole.box.row + hole.box.rows / 2;
    hole.distance_m =
        greatest_distance(open.runs, hole.box, cols_, rows_, spacing_[std::size_t(middle)]);
    hole.has_rim = open.rim_count > 0;
    if (hole.has_rim) hole.rim_mean_m = open.rim_sum / double(open.rim_count);
    done_.push_back(hole);
    open = {};
  }

  int cols_, rows_, row_ = 0;
  std::vector<Spacing> spacing_;
  std::vector<OpenHole> open_;  // those that reach the latest row
  std::vector<TipRun> tips_;    // their runs in it
  std::vector<std::uint8_t> known_above_;
  std::vector<float> z_above_;
  std::vector<Hole> done_;
};

HoleScanner::HoleScanner(int cols, std::vector<Spacing> spacing)
    : scan_(std::make_unique<Scan>(cols, std::move(spacing))) {}
HoleScanner::~HoleScanner() = default;
HoleScanner::HoleScanner(HoleScanner&&) noexcept = default;
HoleScanner& HoleScanner::operator=(HoleScanner&&) noexcept = default;

void HoleScanner::add_row(std::span<const std::uint8_t> known, std::span<const float> z,
                          std::span<const std::uint8_t> marked) {
  scan_->add_row(known, z, marked);
}

std::vector<Hole> HoleScanner::finish() { return scan_->finish(); }

std::vector<Hole> find_holes(const Dem& dem, std::vector<Spacing> spacing, const Mask& marked) {
  check_shape(dem);
  if (spacing.empty()) spacing.assign(std::size_t(dem.size().rows), dem.spacing);
  HoleScanner scanner(dem.size().cols, std::move(spacing));
  for (int row = 0; row < dem.size().rows; ++row)
    scanner.add_row(dem.known.row(row), dem.z.row(row),
                    marked.empty() ? std::span<const std::uint8_t>() : marked.row(row));
  return scanner.finish();
}

std::vector<std::vector<CellRun>> cells_of_holes(const Mask& known,
                                                 const std::vector<FirstCell>& holes) {
  Mask taken(known.size());
  std::vector<CellRun> waiting;
  const auto is_open = [&](int c, int r) { return !known(c, r) && !taken(c, r); };
  // The whole run that a cell lies in.
  const auto take = [&](int col, int row) {
    int begin = col, end = col + 1;
    while (begin > 0 && is_open(begin - 1, row)) --begin;
    while (end < known.cols() && is_open(end, row)) ++end;
    std::fill_n(taken.row(row).begin() + begin, end - begin, std::uint8_t{1});
    waiting.push_back({row, begin, end});
  };
  std::vector<std::vector<CellRun>> all;
  for (const auto& [col, row] : holes) {
    if (!known.contains(col, row) || !is_open(col, row))
      throw std::logic_error("a hole begins at an unknown cell of its own");
    std::vector<CellRun>& runs = all.emplace_back();
    take(col, row);
    while (!waiting.empty()) {
      const CellRun run = waiting.back();
      waiting.pop_back();
      runs.push_back(run);
      for (const int r : {run.row - 1, run.row + 1}) {
        if (r < 0 || r >= known.rows()) continue;
        for (int c = std::max(0, run.begin - 1); c < std::min(known.cols(), run.end + 1); ++c)
          if (is_open(c, r)) take(c, r);
      }
    }
    std::ranges::sort(runs, [](const CellRun& a, const CellRun& b) {
      return a.row != b.row ? a.row < b.row : a.begin < b.begin;
    });
  }
  return all;
}

}  // namespace dem
