#include "dem/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

/// Points nearer to a centre than this part of a cell lie on it: coordinates as text are rounded.
constexpr double on_centre = 1e-6;

/// Cells to a band of rows: its bins fit into a core's cache.
constexpr int band_cells = 1 << 15;

/// Points that are sorted into bands at a time.
constexpr std::size_t buffer_points = std::size_t(1) << 21;
constexpr std::size_t chunk_points = std::size_t(1) << 15;

/// One point, sorted into its band.
struct Record {
  std::uint32_t cell;  // within the band
  float dx, dy, z, weight;
};

/// What is known of one cell. Mean: weighted sums; min, max: the point so far.
struct Bin {
  double z = 0;
  float weight = 0, dx = 0, dy = 0;
  std::uint32_t points = 0;

  bool known() const { return points > 0; }
};

/// Where a cell's elevation was measured.
struct Centroid {
  double dx, dy, z;
};

/// World to (col, row).
class ToCells {
 public:
  explicit ToCells(const GeoRef& ref) : at_(ref.to_world) {
    const double det = at_[1] * at_[5] - at_[2] * at_[4];
    if (!std::isfinite(1 / det))
      throw std::invalid_argument(
          fmt::format("to_world = ({}); must be finite, with cells that "
                      "have an area",
                      fmt::join(at_, ", ")));
    inverse_ = {at_[5] / det, -at_[2] / det, -at_[4] / det, at_[1] / det};
  }
  std::pair<double, double> operator()(double x, double y) const {
    const double u = x - at_[0], v = y - at_[3];
    return {inverse_[0] * u + inverse_[1] * v, inverse_[2] * u + inverse_[3] * v};
  }

 private:
  std::array<double, 6> at_;
  std::array<double, 4> inverse_{};
};

float offset_in_cell(double position, double cell) {
  const double offset = position - cell;
  return std::abs(offset) < on_centre ? 0.F : float(offset);
}

void check_points(const Points& p) {
  const auto same = [&](std::size_t n, const char* name) {
    if (n != p.size())
      throw std::invalid_argument(
          fmt::format("points: {} has {} numbers; must have {} as z", name, n, p.size()));
  };
  same(p.x.size(), "x");
  same(p.y.size(), "y");
  if (!p.sigma.empty()) same(p.sigma.size(), "sigma");
  if (!p.weight.empty()) same(p.weight.size(), "weight");
  const auto positive = [](const std::vector<float>& values, const char* name) {
    for (const float v : values)
      if (!(v > 0) || !std::isfinite(v))
        throw std::invalid_argument(fmt::format("{} = {}; must be above 0", name, v));
  };
  positive(p.sigma, "sigma");
  positive(p.weight, "weight");
}

float weight_of(const Points& p, std::size_t i) {
  if (!p.sigma.empty()) return 1 / (p.sigma[i] * p.sigma[i]);
  return p.weight.empty() ? 1.F : p.weight[i];
}

/// Eigenvalues below this part of the larger one leave the slope along them open.
constexpr double least_eigenvalue = 1e-3;

/// Added to squared distances, in cells^2: points closer than a cell differ by their errors rather
/// than by the slope.
constexpr double softening = 1;

/// Weighted least squares of z = slope_x dx + slope_y dy: the shortest slope that fits best.
class SlopeFit {
 public:
  void add(double dx, double dy, double dz) {
    const double near2 = dx * dx + dy * dy + softening;
    const double w = 1 / (near2 * near2);
    xx_ += w * dx * dx;
    xy_ += w * dx * dy;
    yy_ += w * dy * dy;
    xz_ += w * dx * dz;
    yz_ += w * dy * dz;
    zz_ += w * dz * dz;
    weights_ += w;
    squared_weights_ += w * w;
  }

  /// The slope shrinks by what chance explains: to 0 where the heights around are noise.
  std::pair<double, double> slope() const {
    const auto [x, y] = fitted();
    const double explained = x * xz_ + y * yz_, rest = std::max(0., zz_ - explained);
    const double n = weights_ * weights_ / std::max(squared_weights_, 1e-300);
    if (!(explained > 0) || n <= 3) return {x, y};
    const double kept = std::max(0., 1 - 2 / (n - 2) * rest / explained);
    return {kept * x, kept * y};
  }

 private:
  std::pair<double, double> fitted() const {
    const double middle = (xx_ + yy_) / 2, half = (xx_ - yy_) / 2, radius = std::hypot(half, xy_);
    const double large = middle + radius, small = middle - radius;
    if (!(large > 0)) return {0, 0};
    if (small > least_eigenvalue * large) {
      const double det = xx_ * yy_ - xy_ * xy_;
      return {(yy_ * xz_ - xy_ * yz_) / det, (xx_ * yz_ - xy_ * xz_) / det};
    }
    // Points on a line: the slope along it only. (ux, uy): the larger eigenvector, doubled angle
    // halved without trigonometry.
    double ux = half + radius, uy = xy_;
    if (ux * ux + uy * uy <= 1e-12 * radius * radius) ux = 0, uy = 1;
    const double norm = ux * ux + uy * uy;
    const double along = (ux * xz_ + uy * yz_) / (large * norm);
    return {along * ux, along * uy};
  }

  double xx_ = 0, xy_ = 0, yy_ = 0, xz_ = 0, yz_ = 0, zz_ = 0;
  double weights_ = 0, squared_weights_ = 0;
};

/// Median of `values`, which are reordered.
float median_of(std::vector<float>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct Neighbourhood {
  float median = 0, spread = -1;  // spread < 0: too few cells around
};

/// The nearest rings that hold 24 known cells, at most 32 cells away.
Neighbourhood neighbourhood(const Dem& dem, int col, int row) {
  constexpr std::size_t wanted = 24, least = 5;
  std::vector<float> z;
  const auto take = [&](int x, int y) {
    if (dem.known.contains(x, y) && dem.known(x, y)) z.push_back(dem.z(x, y));
  };
  for (int r = 1; r <= 32 && z.size() < wanted; ++r) {
    for (int x = col - r; x <= col + r; ++x) take(x, row - r), take(x, row + r);
    for (int y = row - r + 1; y < row + r; ++y) take(col - r, y), take(col + r, y);
  }
  if (z.size() < least) return {};
  Neighbourhood n;
  n.median = median_of(z);
  for (float& v : z) v = std::abs(v - n.median);
  n.spread = 1.4826F * median_of(z);
  return n;
}

/// Makes cells unknown that are no heights of this terrain; returns how many.
std::size_t reject_outliers(Dem& dem, double times, const Run& run) {
  const Size size = dem.size();
  constexpr float least_spread_m = 0.1F;
  Raster<float> spread(size, -1), median(size);
  for (int from = 0; from < size.rows; from += 256) {
    run.report(double(from) / size.rows, "looking for outliers");
    parallel_for(from, std::min(size.rows, from + 256), 8, [&](int row) {
      for (int col = 0; col < size.cols; ++col) {
        if (!dem.known(col, row)) continue;
        const Neighbourhood n = neighbourhood(dem, col, row);
        spread(col, row) = n.spread;
        median(col, row) = n.median;
      }
    });
  }
  std::vector<float> spreads;
  for (const float s : spread.cells())
    if (s >= 0) spreads.push_back(s);
  if (spreads.empty()) return 0;
  const float usual = std::max(least_spread_m, median_of(spreads));
  std::size_t rejected = 0;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const float limit = float(times) * std::max(usual, spread(col, row));
      if (spread(col, row) < 0 || std::abs(dem.z(col, row) - median(col, row)) <= limit) continue;
      dem.known(col, row) = 0;
      dem.z(col, row) = 0;
      ++rejected;
    }
  return rejected;
}

/// The cells of a window, whose first is `from`, that breaks part from a cell; empty when none is
/// broken.
Mask cells_beyond(const Mask& breaks, Cell cell, Cell from, Size size) {
  if (!is_broken(breaks, from.col, from.row, size.cols, size.rows)) return {};
  Mask known(size), within(size);
  for (int y = 0; y < size.rows; ++y)
    std::copy_n(breaks.row(from.row + y).begin() + from.col, size.cols, within.row(y).begin());
  known(cell.col - from.col, cell.row - from.row) = 1;
  return cells_closed_off(known, within);
}

/// Whether cubic convolution at a point would look across a break.
bool looks_across(const Mask& breaks, const OffCentre& p) {
  if (breaks.empty()) return false;
  const int x0 = std::max(0, p.col - (p.dx < 0 ? 2 : 1)),
            y0 = std::max(0, p.row - (p.dy < 0 ? 2 : 1));
  return is_broken(breaks, x0, y0, std::min(4, breaks.cols() - x0),
                   std::min(4, breaks.rows() - y0));
}

}  // namespace

struct PointBins::Bins {
  Lattice lattice;
  BinOptions options;
  Breaklines lines;
  ToCells to_cells;
  int band_rows;
  std::vector<std::vector<Bin>> bands;           // empty until a point falls there
  std::vector<std::vector<Record>> band_points;  // of the median
  std::vector<std::size_t> band_duplicates;
  std::size_t points = 0, outside = 0, parted = 0;
  bool has_sigma = false;
  std::vector<Record> sorted;  // buffer

  Bins(Lattice l, const BinOptions& o, Breaklines breaklines)
      : lattice(std::move(l)), options(o), lines(std::move(breaklines)), to_cells(lattice.ref) {
    check_options(options);
    const Size size = lattice.size;
    if (size.cols < 1 || size.rows < 1)
      throw std::invalid_argument(
          fmt::format("lattice = {} x {}; must have at least one cell", size.cols, size.rows));
    band_rows = std::max(1, band_cells / size.cols);
    const auto n = std::size_t((size.rows + band_rows - 1) / band_rows);
    bands.resize(n);
    band_points.resize(n);
    band_duplicates.resize(n);
  }

  std::size_t band_size(std::size_t band) const {
    const int begin = int(band) * band_rows;
    return std::size_t(std::min(band_rows, lattice.size.rows - begin)) *
           std::size_t(lattice.size.cols);
  }

  /// The record of a point, and its band; nothing when it lies outside.
  std::optional<std::pair<std::uint32_t, Record>> locate(const Points& p, std::size_t i) const {
    const auto [u, v] = to_cells(p.x[i], p.y[i]);
    const double col = std::floor(u + 0.5), row = std::floor(v + 0.5);
    if (!(col >= 0 && row >= 0 && col < lattice.size.cols && row < lattice.size.rows) ||
        !std::isfinite(p.z[i]))
      return {};
    const int r = int(row), band = r / band_rows;
    const auto cell =
        std::uint32_t(r - band * band_rows) * std::uint32_t(lattice.size.cols) + std::uint32_t(col);
    return std::pair(std::uint32_t(band), Record{cell, offset_in_cell(u, col),
                                                 offset_in_cell(v, row), p.z[i], weight_of(p, i)});
  }

  /// Whether a breakline passes between a point and its cell's centre.
  bool is_parted(std::uint32_t band, const Record& r) const {
    if (lines.empty()) return false;
    const auto cols = std::uint32_t(lattice.size.cols);
    return lines.between(int(r.cell % cols), int(band) * band_rows + int(r.cell / cols),
                         double(r.dx), double(r.dy));
  }

  void add_part(const Points& points, std::size_t begin, std::size_t end);
  void bin_band(std::size_t band, std::span<const Record> records);
  Centroid centroid(const Bin& bin) const;
  const Bin& bin_at(int col, int row) const;
  std::pair<double, double> slope_at(const Mask& known, int col, int row, const Centroid& own,
                                     int radius) const;
  template <class Each>
  void each_cell(int band, const Each& each) const;
  void combine(Binned& out, const Run& run);
  void move_to_centres(Binned& out, const Run& run) const;
  std::vector<Bin> medians(std::size_t band) const;
  bool by_mean() const { return options.combine == Combine::mean; }
};

/// Sorts the points [begin, end) by band, in their order, then bins each band.
void PointBins::Bins::add_part(const Points& p, std::size_t begin, std::size_t end) {
  const std::size_t bands_n = bands.size();
  const int chunks = int((end - begin + chunk_points - 1) / chunk_points);
  // at[chunk][band]: first how many, then where the chunk's records of this band go.
  std::vector<std::uint32_t> at(std::size_t(chunks) * bands_n);
  std::vector<std::size_t> parted_in(static_cast<std::size_t>(chunks));
  const auto each_of = [&](int chunk, const auto& each) {
    const std::size_t from = begin + std::size_t(chunk) * chunk_points;
    std::size_t parted_here = 0;
    for (std::size_t i = from; i < std::min(end, from + chunk_points); ++i)
      if (const auto found = locate(p, i)) {
        if (is_parted(found->first, found->second))
          ++parted_here;
        else
          each(std::size_t(chunk) * bands_n + found->first, found->second);
      }
    parted_in[std::size_t(chunk)] = parted_here;
  };
  parallel_for(0, chunks, 1, [&](int chunk) {
    each_of(chunk, [&](std::size_t slot, const Record&) { ++at[slot]; });
  });
  std::size_t parted_now = 0;
  for (const std::size_t n : parted_in) parted_now += n;
  parted += parted_now;
  std::vector<std::uint32_t> first(bands_n + 1);
  std::uint32_t sum = 0;
  for (std::size_t band = 0; band < bands_n; ++band) {
    first[band] = sum;
    for (int chunk = 0; chunk < chunks; ++chunk)
      sum += std::exchange(at[std::size_t(chunk) * bands_n + band], sum);
  }
  first[bands_n] = sum;
  outside += end - begin - sum - parted_now;
  if (sorted.size() < sum) sorted.resize(std::min(buffer_points, p.size()));
  parallel_for(0, chunks, 1, [&](int chunk) {
    each_of(chunk, [&](std::size_t slot, const Record& record) { sorted[at[slot]++] = record; });
  });
  parallel_for(0, int(bands_n), 1, [&](int band) {
    const auto b = std::size_t(band);
    bin_band(b, std::span(sorted).subspan(first[b], first[b + 1] - first[b]));
  });
}

void PointBins::Bins::bin_band(std::size_t band, std::span<const Record> records) {
  if (records.empty()) return;
  if (options.combine == Combine::median) {
    band_points[band].insert(band_points[band].end(), records.begin(), records.end());
    return;
  }
  auto& bins = bands[band];
  if (bins.empty()) bins.resize(band_size(band));
  for (const Record& r : records) {
    Bin& bin = bins[r.cell];
    if (bin.known()) {
      const Centroid so_far = centroid(bin);
      band_duplicates[band] += std::abs(so_far.dx - double(r.dx)) < on_centre &&
                               std::abs(so_far.dy - double(r.dy)) < on_centre &&
                               float(so_far.z) != r.z;
    }
    if (by_mean()) {
      bin.z += double(r.weight) * double(r.z);
      bin.weight += r.weight;
      bin.dx += r.weight * r.dx;
      bin.dy += r.weight * r.dy;
    } else if (!bin.known() ||
               (options.combine == Combine::min ? double(r.z) < bin.z : double(r.z) > bin.z)) {
      bin.z = double(r.z);
      bin.weight = r.weight;
      bin.dx = r.dx;
      bin.dy = r.dy;
    }
    ++bin.points;
  }
}

Centroid PointBins::Bins::centroid(const Bin& bin) const {
  if (!by_mean()) return {double(bin.dx), double(bin.dy), bin.z};
  const double w = double(bin.weight);
  return {double(bin.dx) / w, double(bin.dy) / w, bin.z / w};
}

/// The bins of a band whose cells take the lower median of their points.
std::vector<Bin> PointBins::Bins::medians(std::size_t band) const {
  std::vector<Record> records = band_points[band];
  std::vector<Bin> bins(records.empty() ? 0 : band_size(band));
  std::ranges::stable_sort(records, [](const Record& a, const Record& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.z < b.z;
  });
  for (auto from = records.begin(); from != records.end();) {
    const auto to =
        std::find_if(from, records.end(), [&](const Record& r) { return r.cell != from->cell; });
    const Record& r = from[(to - from - 1) / 2];
    bins[r.cell] = {double(r.z), r.weight, r.dx, r.dy, std::uint32_t(to - from)};
    from = to;
  }
  return bins;
}

/// The bin of a known cell.
const Bin& PointBins::Bins::bin_at(int col, int row) const {
  return bands[std::size_t(row / band_rows)]
              [std::size_t(row % band_rows) * std::size_t(lattice.size.cols) + std::size_t(col)];
}

/// Slope in metres a column and a row at a cell, from the known cells within `radius`; from twice
/// as far when fewer than three are there.
std::pair<double, double> PointBins::Bins::slope_at(const Mask& known, int col, int row,
                                                    const Centroid& own, int radius) const {
  for (int r = radius;; r *= 2) {
    SlopeFit fit;
    int found = 0;
    const int x0 = std::max(0, col - r), x1 = std::min(lattice.size.cols - 1, col + r);
    const int y0 = std::max(0, row - r), y1 = std::min(lattice.size.rows - 1, row + r);
    const Mask beyond =
        cells_beyond(lines.breaks(), {col, row}, {x0, y0}, {x1 - x0 + 1, y1 - y0 + 1});
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        if (!known(x, y) || (x == col && y == row)) continue;
        if (!beyond.empty() && beyond(x - x0, y - y0)) continue;
        const Centroid c = centroid(bin_at(x, y));
        fit.add(x - col + c.dx - own.dx, y - row + c.dy - own.dy, c.z - own.z);
        ++found;
      }
    if (found >= 3 || r > 4 * radius) return fit.slope();
  }
}

/// Calls each(bin, col, row) for every cell of a band that has points.
template <class Each>
void PointBins::Bins::each_cell(int band, const Each& each) const {
  const auto& bins = bands[std::size_t(band)];
  const auto cols = std::size_t(lattice.size.cols);
  for (std::size_t i = 0; i < bins.size(); ++i)
    if (bins[i].known()) each(bins[i], int(i % cols), band * band_rows + int(i / cols));
}

/// Heights as measured, where there are points; and the counts.
void PointBins::Bins::combine(Binned& out, const Run& run) {
  run.report(0, "combining points");
  struct PerBand {
    std::size_t cells = 0, combined = 0;
  };
  std::vector<PerBand> counts(bands.size());
  parallel_for(0, int(bands.size()), 1, [&](int band) {
    if (options.combine == Combine::median) bands[std::size_t(band)] = medians(std::size_t(band));
    PerBand& mine = counts[std::size_t(band)];
    each_cell(band, [&](const Bin& bin, int col, int row) {
      out.dem.z(col, row) = float(centroid(bin).z);
      out.dem.known(col, row) = 1;
      ++mine.cells;
      if (bin.points > 1) mine.combined += bin.points;
    });
  });
  for (std::size_t i = 0; i < bands.size(); ++i) {
    out.counts.cells += counts[i].cells;
    out.counts.combined += counts[i].combined;
    out.counts.duplicates += band_duplicates[i];
  }
}

/// Moves the heights of `out` along the slopes around them, lists the cells that were moved, and
/// writes their sigma.
void PointBins::Bins::move_to_centres(Binned& out, const Run& run) const {
  const Size size = lattice.size;
  if (has_sigma) out.sigma = Raster<float>(size);
  // The window of a slope holds about a dozen known cells.
  const double density = double(std::max<std::size_t>(1, out.counts.cells)) / double(size.cells());
  const int radius = std::clamp(int(std::ceil(std::sqrt(12 / density) / 2 - 0.5)), 1, 24);
  const int n = int(bands.size());
  std::vector<std::vector<OffCentre>> off_centre(bands.size());
  constexpr int bands_at_a_time = 64;
  for (int from = 0; from < n; from += bands_at_a_time) {
    run.report(double(from) / n, "moving points to cell centres");
    parallel_for(from, std::min(n, from + bands_at_a_time), 1, [&](int band) {
      each_cell(band, [&](const Bin& bin, int col, int row) {
        if (!out.dem.known(col, row)) return;
        if (has_sigma) out.sigma(col, row) = 1 / std::sqrt(bin.weight);
        const Centroid c = centroid(bin);
        if (c.dx == 0 && c.dy == 0) return;
        const OffCentre off{col, row, float(c.dx), float(c.dy), float(c.z)};
        if (!looks_across(lines.breaks(), off)) off_centre[std::size_t(band)].push_back(off);
        if (!options.plane) return;
        const auto [slope_x, slope_y] = slope_at(out.dem.known, col, row, c, radius);
        out.dem.z(col, row) = float(c.z - slope_x * c.dx - slope_y * c.dy);
      });
    });
  }
  for (const auto& part : off_centre)
    out.off_centre.insert(out.off_centre.end(), part.begin(), part.end());
}

std::vector<Field> fields(BinOptions& o) {
  return {{"combine",
           o.combine,
           {"mean", "min", "max", "median"},
           "what becomes of several points in one cell"},
          {"plane", o.plane,
           "a height is moved to the centre of its cell along the plane through the cells around; "
           "false: it is taken as it is"},
          {"outliers",
           o.outliers,
           {0, 1e9},
           "",
           "drop cells more than this number of robust standard deviations from their neighbours; "
           "0: drop none"}};
}

PointBins::PointBins(Lattice lattice, const BinOptions& options, Breaklines lines)
    : bins_(std::make_unique<Bins>(std::move(lattice), options, std::move(lines))) {}
PointBins::~PointBins() = default;
PointBins::PointBins(PointBins&&) noexcept = default;
PointBins& PointBins::operator=(PointBins&&) noexcept = default;

void PointBins::add(const Points& points, const Run& run) {
  check_points(points);
  Bins& b = *bins_;
  if (points.size() == 0) return;
  b.has_sigma |= !points.sigma.empty();
  b.points += points.size();
  with_threads(run.threads, [&] {
    for (std::size_t begin = 0; begin < points.size(); begin += buffer_points) {
      run.report(double(begin) / double(points.size()), "binning points");
      b.add_part(points, begin, std::min(points.size(), begin + buffer_points));
    }
  });
}

Binned PointBins::finish(const Run& run) const {
  Bins& b = *bins_;
  const Size size = b.lattice.size;
  Binned out{{Raster<float>(size), Mask(size), b.lattice.ref, b.lattice.spacing}, {}, {}, {}};
  out.counts.points = b.points;
  out.counts.outside = b.outside;
  out.counts.parted = b.parted;
  out.dem.breaks = b.lines.breaks();
  with_threads(run.threads, [&] {
    b.combine(out, run.part(0, 0.2));
    if (b.options.outliers > 0)
      out.counts.outliers = reject_outliers(out.dem, b.options.outliers, run.part(0.2, 0.4));
    out.counts.cells -= out.counts.outliers;
    b.move_to_centres(out, run.part(0.4, 1));
  });
  return out;
}

Binned bin_points(const Points& points, const Lattice& lattice, const BinOptions& options,
                  const Run& run) {
  PointBins bins(lattice, options);
  bins.add(points, run.part(0, 0.6));
  return bins.finish(run.part(0.6, 1));
}

void Extent::add(std::span<const double> xs, std::span<const double> ys) {
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const double x = xs[i], y = ys[i];
    if (points == 0) west = east = x, south = north = y;
    west = std::min(west, x);
    east = std::max(east, x);
    south = std::min(south, y);
    north = std::max(north, y);
    ++points;
  }
}

double cell_for_density(double width, double height, std::size_t points) {
  const double area = width * height;
  if (!(area > 0) || points == 0 || !std::isfinite(area)) return 0;
  const double cell = std::sqrt(area / double(points)) / 2;
  const double decade = std::pow(10, std::floor(std::log10(cell)));
  for (const double step : {5., 2., 1.})
    if (step * decade <= cell * (1 + 1e-9)) return step * decade;
  return decade;
}

}  // namespace dem
