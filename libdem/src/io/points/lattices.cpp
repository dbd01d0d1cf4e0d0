#include "dem/io/lattices.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "dem/io/geodesy.h"
#include "io/crs.h"

namespace dem {
using namespace io;
namespace {

constexpr double most_cells = 2147483647;

/// How many steps of `step` reach over `length`; a rest below a millionth of a step is rounding.
int steps_over(const char* name, double length, double step) {
  const double steps = std::ceil(length / step - 1e-6);
  if (!(steps < most_cells))
    throw std::invalid_argument(
        fmt::format("cell = {}: {:.3g} {} of cells; must be fewer than 2^31", step, steps, name));
  return int(steps);
}

/// Width and height of a cell in the units of the system.
std::pair<double, double> in_units(CellSize cell, const Bounds& b, const std::string& crs_wkt) {
  const CrsUnits crs = crs_units(crs_wkt);
  if (cell.unit == CellUnit::degrees) {
    if (!crs.geographic)
      throw std::invalid_argument(fmt::format(
          "cell = {} degrees; must be in metres (30m), as the lattice has no degrees", cell.value));
    return {cell.value / crs.unit, cell.value / crs.unit};
  }
  if (!crs.geographic) return {cell.value / crs.unit, cell.value / crs.unit};
  // A cell of a thousandth of a degree, measured in the middle.
  constexpr double small = 1e-3;
  const GeoRef probe{{(b.west + b.east) / 2, small, 0, (b.south + b.north) / 2, 0, -small},
                     crs_wkt};
  const Spacing metres = middle_spacing(probe, {1, 1});
  return {small * cell.value / metres.dx_m, small * cell.value / metres.dy_m};
}

/// Nodes `dx` and `dy` apart, the first at (west, north).
Lattice make_lattice(double west, double north, double dx, double dy, int cols, int rows,
                     const std::string& crs_wkt) {
  if (double(cols) * double(rows) > most_cells)
    throw std::invalid_argument(fmt::format(
        "lattice = {} x {} cells; must have fewer than 2^31: take larger cells", cols, rows));
  Lattice lattice{{{west, dx, 0, north, 0, -dy}, crs_wkt}, {cols, rows}, {}};
  lattice.spacing = middle_spacing(lattice.ref, lattice.size);
  return lattice;
}

double parse_whole(const char* name, const std::string& text, std::string_view number,
                   std::string_view must_be) {
  double value = 0;
  const char* end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value))
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", name, text, must_be));
  return value;
}

}  // namespace

CellSize parse_cell_size(const std::string& text) {
  struct Unit {
    std::string_view suffix;
    double factor;
    CellUnit unit;
  };
  constexpr std::array units{Unit{"deg", 1, CellUnit::degrees},
                             Unit{"min", 1 / 60., CellUnit::degrees},
                             Unit{"sec", 1 / 3600., CellUnit::degrees},
                             Unit{"s", 1 / 3600., CellUnit::degrees},
                             Unit{"km", 1000, CellUnit::metres},
                             Unit{"m", 1, CellUnit::metres},
                             Unit{"", 1, CellUnit::metres}};
  constexpr auto must_be = "a size above 0: 30 or 30m, 1s (arc second), 0.001deg";
  for (const Unit& u : units) {
    if (!text.ends_with(u.suffix)) continue;
    const std::string_view number(text.data(), text.size() - u.suffix.size());
    const double value = parse_whole("cell", text, number, must_be) * u.factor;
    if (value > 0) return {value, u.unit};
    break;
  }
  throw std::invalid_argument(fmt::format("cell = {}; must be {}", text, must_be));
}

Bounds parse_bounds(const std::string& text) {
  constexpr auto must_be = "W,S,E,N with W < E and S < N, in the units of the lattice";
  std::array<double, 4> v{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t comma = i < 3 ? rest.find(',') : rest.size();
    if (comma == rest.npos)
      throw std::invalid_argument(fmt::format("bounds = {}; must be {}", text, must_be));
    v[i] = parse_whole("bounds", text, rest.substr(0, comma), must_be);
    rest.remove_prefix(std::min(rest.size(), comma + 1));
  }
  if (!(v[0] < v[2] && v[1] < v[3]))
    throw std::invalid_argument(fmt::format("bounds = {}; must be {}", text, must_be));
  return {v[0], v[1], v[2], v[3]};
}

Lattice lattice_over(const Bounds& b, CellSize cell, const std::string& crs_wkt, bool nodes) {
  if (!(b.west < b.east && b.south < b.north))
    throw std::invalid_argument(
        fmt::format("bounds = {},{},{},{}; must be W,S,E,N with W < E and "
                    "S < N",
                    b.west, b.south, b.east, b.north));
  const auto [dx, dy] = in_units(cell, b, crs_wkt);
  const int cols = steps_over("columns", b.east - b.west, dx) + (nodes ? 1 : 0);
  const int rows = steps_over("rows", b.north - b.south, dy) + (nodes ? 1 : 0);
  const double half = nodes ? 0 : 0.5;
  return make_lattice(b.west + half * dx, b.north - half * dy, dx, dy, cols, rows, crs_wkt);
}

Lattice lattice_for(const Extent& e, const std::string& crs_wkt) {
  const CrsUnits crs = crs_units(crs_wkt);
  // On degrees, distances east are shorter by the cosine of the latitude.
  constexpr double small = 1e-3;
  double shorter = 1;
  if (crs.geographic) {
    const GeoRef probe{{e.west, small, 0, (e.south + e.north) / 2, 0, -small}, crs_wkt};
    const Spacing metres = middle_spacing(probe, {1, 1});
    shorter = metres.dx_m / metres.dy_m;
  }
  const double cell = cell_for_density((e.east - e.west) * shorter, e.north - e.south, e.points);
  if (!(cell > 0))
    throw std::invalid_argument(
        fmt::format("the {} point{} cover{} no area; bounds and cell, or like, must be given",
                    e.points, e.points == 1 ? "" : "s", e.points == 1 ? "s" : ""));
  const double west = std::round(e.west / cell) * cell, north = std::round(e.north / cell) * cell;
  const int cols = steps_over("columns", e.east - west, cell) + 1;
  const int rows = steps_over("rows", north - e.south, cell) + 1;
  return make_lattice(west, north, cell, cell, cols, rows, crs_wkt);
}

}  // namespace dem
