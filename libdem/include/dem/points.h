#pragma once
// Scattered elevations, and how they come onto a lattice.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dem/breaklines.h"
#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// Points with an elevation in metres; x and y in the units of some coordinate system.
struct Points {
  std::vector<double> x, y;
  std::vector<float> z;
  std::vector<float> sigma;   ///< standard deviation of z in metres, one a point; or empty
  std::vector<float> weight;  ///< how much a point counts in a mean, one a point; or empty

  std::size_t size() const { return z.size(); }
};

/// Cells without heights.
struct Lattice {
  GeoRef ref;
  Size size;
  Spacing spacing;
};

/// What becomes of several points in one cell.
enum class Combine { mean, min, max, median };

struct BinOptions {
  Combine combine = Combine::mean;
  /// A height is moved from where it was measured to the cell's centre along a plane through the
  /// cells around; false: it is taken as it is.
  bool plane = true;
  /// Cells whose height has nothing to do with that of the cells around stay unknown: farther than
  /// `outliers` times the spread of the 24 nearest from their median; 0: none do. Spread: the
  /// larger of 1.4826 median |z - median| and its median over all cells, at least 0.1 m. A cell
  /// with fewer than five others within 32 cells is never taken for an outlier.
  double outliers = 0;
};
std::vector<Field> fields(BinOptions& options);

/// A point that lay off the centre of its cell (several points: their centroid).
struct OffCentre {
  int col = 0, row = 0;
  float dx = 0, dy = 0;  ///< from the centre, in columns and rows, -0.5 to 0.5
  float z = 0;           ///< as measured
};

struct BinCounts {
  std::size_t points = 0;    ///< all that came
  std::size_t outside = 0;   ///< of these, not on the lattice
  std::size_t parted = 0;    ///< of these, parted from their cell's centre by a breakline: left out
  std::size_t combined = 0;  ///< of these, in a cell that others share
  std::size_t duplicates = 0;  ///< of these, at the same place as another with another height
  std::size_t cells = 0;       ///< that became known
  std::size_t outliers = 0;    ///< cells that were taken for outliers
};

struct Binned {
  Dem dem;                            ///< known where there are points
  Raster<float> sigma;                ///< of each known cell; empty when no point had one
  std::vector<OffCentre> off_centre;  ///< row by row; none beside a breakline
  BinCounts counts;
};

/// Points come in parts, and memory does not grow with them (but for the median): 24 bytes for each
/// cell of those stretches of the lattice where points are, and a buffer.
class PointBins {
 public:
  /// `lines`: no plane reaches across one, and a point that one parts from its cell's centre is
  ///          left
  /// out. The DEM has their breaks.
  /// Throws std::invalid_argument for a lattice without cells or a degenerate georeference.
  explicit PointBins(Lattice lattice, const BinOptions& options = {}, Breaklines lines = {});
  ~PointBins();
  PointBins(PointBins&&) noexcept;
  PointBins& operator=(PointBins&&) noexcept;

  /// Throws std::invalid_argument when columns of the points differ in length or a sigma or weight
  /// is not above 0, Cancelled.
  void add(const Points& points, const Run& run = {});

  /// The heights so far, at the cells' centres.
  /// Throws Cancelled.
  Binned finish(const Run& run = {}) const;

 private:
  struct Bins;
  std::unique_ptr<Bins> bins_;
};

/// Brings points onto a lattice: each cell that holds points becomes known.
/// Method:   the cell's points are combined (mean: weighted by 1 / sigma^2, or by weight), height
///           and position alike; then the height goes to the cell's centre along the plane through
///           this centroid that fits those of the cells around best (weights 1 / (distance^2 +
///           1)^2, in cells), as far as chance does not explain its slope: where the heights around
///           are noise, it stays.
/// Exact on: points on a cell's centre (to 1e-6 of a cell); planes.
/// Gives:    sigma = 1 / root of the sum of 1 / sigma^2 for means, else that of the point chosen.
/// Cost:     O(points + cells). Any number of threads gives the same bits.
/// Throws:   as PointBins::add.
Binned bin_points(const Points& points, const Lattice& lattice, const BinOptions& options = {},
                  const Run& run = {});

/// The rectangle that points cover.
struct Extent {
  double west = 0, south = 0, east = 0, north = 0;
  std::size_t points = 0;

  void add(std::span<const double> x, std::span<const double> y);
};

/// The size of a cell that suits points so dense: half the mean distance of `points` spread over
/// width x height, rounded down to 1, 2 or 5 times a power of ten; 0 when there is no area.
double cell_for_density(double width, double height, std::size_t points);

}  // namespace dem
