#pragma once
// A digital elevation model that may have holes, and what a reconstruction of it returns.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dem/raster.h"

namespace dem {

/// Where the cells lie. `to_world` maps the CENTRE of cell (col, row) to CRS units:
///   x = to_world[0] + to_world[1] * col + to_world[2] * row
///   y = to_world[3] + to_world[4] * col + to_world[5] * row
struct GeoRef {
  std::array<double, 6> to_world{0, 1, 0, 0, 0, -1};
  std::string crs_wkt;  ///< empty: no coordinate system is known, units are taken as metres

  bool operator==(const GeoRef&) const = default;
};

/// The georeference of a part of a raster.
GeoRef crop(GeoRef ref, const Box& box);

/// Size of a cell in metres. On a geographic grid dx changes from row to row: one Spacing then
/// stands for the middle row, and Dem::row_spacing has one for every row.
struct Spacing {
  double dx_m = 1;
  double dy_m = 1;

  bool operator==(const Spacing&) const = default;
};

/// Bits of Dem::breaks: a breakline passes between a cell and its neighbour in the east or in the
/// south.
constexpr std::uint8_t break_east = 1, break_south = 2;

/// Heights in metres, a mask and a georeference. Where `known` is 0, `z` means nothing.
struct Dem {
  Raster<float> z;
  Mask known;
  GeoRef ref;
  Spacing spacing;
  /// Where a surface may jump: break_east and break_south of each cell; empty: nowhere.
  Mask breaks{};
  /// Spacing of each row, where rows differ (cells in degrees); empty: `spacing` in every row.
  std::vector<Spacing> row_spacing{};

  Size size() const { return z.size(); }
};

/// The spacing of each row. Throws std::invalid_argument when row_spacing has another length.
std::vector<Spacing> spacing_of_rows(const Dem& dem);

/// A part of a DEM, with a spacing of its own; z is 0 where unknown.
Dem crop(const Dem& dem, const Box& box, Spacing spacing);

/// One number in the report of a reconstruction, for example {"iterations", 7, ""}.
struct Figure {
  std::string name;
  double value = 0;
  std::string unit;
};

/// What a fill method returns: heights without unknown cells, and its report.
struct Filled {
  Raster<float> z;
  Raster<float> sigma{};  ///< standard error in metres, 0 at known cells; empty when not asked for
  std::vector<Figure> report{};
  bool contour_lines = false;  ///< fill_contours: the known cells were contour lines
};

/// Throws std::invalid_argument unless z, known and breaks (if any) have the same size, of at least
/// one cell.
void check_shape(const Dem& dem);

/// As check_shape, and at least one cell must be known.
void check_fillable(const Dem& dem);

}  // namespace dem
