#pragma once
// Midpoint displacement under constraints: MCMD [belhadj2007], and the methods that it grew from,
// MDI [belhadj2005] and plain MD. Their common lattice works for any width and height.

#include <cstdint>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// How a square is subdivided: the midpoint of an edge is the mean of the two ends of the edge, or
/// of its ends and the centres of the squares on both sides.
enum class Subdivision { triangle_edge, diamond_square };

/// How known elevations rise to their ascendants: in the waves of the paper (algorithm 1), or level
/// by level from the finest, where an ascendant follows when its children are complete.
enum class UpOrder { waves, levels };

/// The kind of a known cell. Each kind influences the cells around it in its own way.
enum class CellKind : std::uint8_t { plain = 0, ridge = 1, river = 2 };

/// Options of fill_mcmd. The names are the symbols of the paper.
/// The defaults are the most accurate for measured terrain. The preset `paper` is {triangle_edge,
/// waves, weight_exponent = 0}.
struct McmdOptions {
  Subdivision subdivision = Subdivision::diamond_square;
  UpOrder order = UpOrder::levels;
  double weight_exponent = 3;
  double I = 0;
  double I_bu = 0;
  double I_ridge = 0;
  double I_bu_ridge = 0;
  double I_river = 0;
  double I_bu_river = 0;
  double datum_m = 0;
  double H = 0.5;
  double rt = 0;
  double rs = 0;
  std::uint64_t seed = 1;
  /// Known cells are contour lines, and each has two sides. The ground uphill of it rises by the
  /// slope to the next line above, and the ground downhill falls by the slope to the next line
  /// below.
  bool two_sided = false;
};
std::vector<Field> fields(McmdOptions& options);

/// Fills every unknown cell by the Morphologically Constrained Midpoint Displacement.
/// Method:   [belhadj2007] algorithm 1 and equations 1 to 3. Departures: a lattice of any size; the
///           default order, weights and subdivision (see McmdOptions); centres use both diagonals.
///           two_sided is an open problem of the paper (section 5): a contour cell looks for the
///           nearest known cells above and below it, at most 48 cells away. The unknown cells up to
///           two cells from the line start from these two slopes. It is for contour lines only and
///           off by default, because most data are not contour lines.
/// Needs:    at least one known cell.
/// Gives:    a raster of the same size whose cells are all finite; known cells bit for bit. A
///           corner that no known cell rises to takes the mean of the other corners.
/// Exact on: constants, when I = I_bu = 0 and rs = 0. Not exact on planes.
/// Cost:     O(cells); 5 bytes a cell in addition to the input (waves: 9; two_sided: 50), including
///           the result. Any number of threads gives the same bits.
/// Throws:   std::invalid_argument, Cancelled.
/// `kinds`:  empty, or one CellKind a cell. Ridge and river cells use their own I and I_bu.
Raster<float> fill_mcmd(const Dem& dem, const McmdOptions& options = {}, const Run& run = {},
                        const Raster<CellKind>& kinds = {});

/// The bottom-up half alone (MDBU): the DEM with its ascendants known, ready for fill_md.
Dem carry_up_mcmd(const Dem& dem, const McmdOptions& options = {}, const Run& run = {},
                  const Raster<CellKind>& kinds = {});

/// Options of fill_md, plain midpoint displacement.
struct MdOptions {
  Subdivision subdivision = Subdivision::diamond_square;
  double I = 0;
  double I_ridge = 0;
  double I_river = 0;
  double datum_m = 0;
  double H = 0.5;
  double rt = 0;
  double rs = 0;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(MdOptions& options);

/// Fills every unknown cell by midpoint displacement from the corners down, and keeps known cells.
/// Unknown corners start at datum_m. Sparse data therefore leave the spikes that MCMD avoids
/// ([belhadj2007] figures 4 and 5), and a DEM without a known cell becomes a fractal.
/// Method: [belhadj2007] section 3.1, equations 1 and 2.
/// It gives, costs and throws the same as fill_mcmd, but needs no known cell.
Raster<float> fill_md(const Dem& dem, const MdOptions& options = {}, const Run& run = {},
                      const Raster<CellKind>& kinds = {});

/// Options of fill_mdi, the ancestor of MCMD.
struct MdiOptions {
  Subdivision subdivision = Subdivision::triangle_edge;
  double rs_bu = 1;
  double datum_m = 0;
  double H = 0.5;
  double rt = 0;
  double rs = 0;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(MdiOptions& options);

/// Fills every unknown cell by the Midpoint Displacement's Inverse process, then by plain MD.
/// Method: [belhadj2005] section 3.3, with the waves of its queue. An ascendant gets the plain mean
///         of its children plus (mean distance in cells) * rs_bu * uniform[-1, 1] metres. rs_bu = 1
///         is the noise of the paper.
/// It gives, costs and throws the same as fill_mcmd.
Raster<float> fill_mdi(const Dem& dem, const MdiOptions& options = {}, const Run& run = {});

/// The bottom-up half of fill_mdi alone.
Dem carry_up_mdi(const Dem& dem, const MdiOptions& options = {}, const Run& run = {});

}  // namespace dem
