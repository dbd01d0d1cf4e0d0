#include "dem/io/grid_points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/holes.h"
#include "dem/io/geodesy.h"
#include "dem/io/methods.h"
#include "dem/io/rasters.h"

namespace dem {
namespace {

using Path = std::string;

bool has_breaklines(const GridInput& input) {
  const auto* path = std::get_if<Path>(&input.breaklines);
  return path ? !path->empty() : !std::get<std::vector<WorldLine>>(input.breaklines).empty();
}

/// Throws IoError for a file, std::invalid_argument for data in memory.
[[noreturn]] void refuse(const GridInput& input, const std::string& cause,
                         const std::string& field = "") {
  if (const auto* path = std::get_if<Path>(&input.elevations)) throw IoError(*path, cause, field);
  throw std::invalid_argument((has_contours(input) ? "contours: " : "points: ") + cause);
}

void check_honours_breaklines(const FillMethod& method) {
  if (method.traits.honours_breaklines) return;
  std::vector<std::string> others;
  for (const FillMethod& m : all_fill_methods())
    if (m.traits.honours_breaklines) others.push_back(m.name);
  throw std::invalid_argument(fmt::format("breaklines: method {} knows none; these do: {}",
                                          method.name, fmt::join(others, ", ")));
}

void check_lattice(const GridInput& input, const LatticeWish& lattice) {
  if (lattice.like &&
      (lattice.bounds || lattice.cell || lattice.nodes || !input.read.to_crs.empty()))
    throw std::invalid_argument("like says it all: no bounds, cell, nodes or to_crs beside it");
  if (lattice.bounds && !lattice.cell)
    throw std::invalid_argument("bounds needs cell, for example 30m");
  if (lattice.nodes && !lattice.bounds) throw std::invalid_argument("nodes is for bounds");
  if (has_contours(input) && !lattice.like && !lattice.cell)
    throw std::invalid_argument("contours needs cell, for example 30m, or like");
}

/// Delivers the input as read_points does a file.
PointSource read(const GridInput& input, const PointReadOptions& options, const PointSink& sink,
                 const Run& run) {
  if (const auto* path = std::get_if<Path>(&input.elevations))
    return read_points(*path, options, sink, run);
  if (const auto* points = std::get_if<Points>(&input.elevations))
    return deliver_points(*points, options, sink);
  return deliver_contours(std::get<std::vector<ContourLine>>(input.elevations), options, sink);
}

/// How the input is read, when it must come into the coordinate system of a given lattice.
PointReadOptions read_options(const GridInput& input, const LatticeWish& wish) {
  PointReadOptions options = input.read;
  if (wish.like && !wish.like->ref.crs_wkt.empty()) options.to_crs = wish.like->ref.crs_wkt;
  return options;
}

/// The lattice, once the extent of the points and their coordinate system are known.
Lattice chosen_lattice(const LatticeWish& wish, const Extent& extent, const std::string& crs) {
  if (wish.like) return *wish.like;
  if (!wish.cell) return lattice_for(extent, crs);
  const Bounds bounds =
      wish.bounds.value_or(Bounds{extent.west, extent.south, extent.east, extent.north});
  if (!wish.bounds && !(bounds.west < bounds.east && bounds.south < bounds.north))
    throw std::invalid_argument("the points cover no area; bounds must be given");
  return lattice_over(bounds, *wish.cell, crs, wish.nodes || !wish.bounds);
}

std::string lattice_from(const LatticeWish& wish) {
  return wish.like     ? "as " + wish.like_name
         : wish.bounds ? "as asked for"
         : wish.cell   ? "bounds from the points"
                       : "cells of half the points' mean distance";
}

Breaklines breaklines_on(const GridInput& input, const Lattice& lattice) {
  if (!has_breaklines(input)) return {};
  const auto* path = std::get_if<Path>(&input.breaklines);
  const std::string crs = input.read.crs.empty() ? "" : crs_from_text(input.read.crs);
  Breaklines lines = path ? read_breaklines(*path, lattice.ref, lattice.size)
                          : make_breaklines(std::get<std::vector<WorldLine>>(input.breaklines), crs,
                                            lattice.ref, lattice.size);
  if (std::ranges::any_of(lines.breaks().cells(), [](auto b) { return b != 0; })) return lines;
  const std::string cause = "none of its lines passes between two cells of the lattice";
  if (path) throw IoError(*path, cause);
  throw std::invalid_argument("breaklines: " + cause);
}

/// Points so close along contour lines that the lines cross no cell unnoticed. `vertices` is the
/// extent of a first reading, in the coordinate system of the lattice.
double spacing_along_lines(const GridInput& input, const Lattice& lattice, const Extent& vertices,
                           const Run& run) {
  constexpr double part_of_cell = 0.4;
  PointReadOptions as_they_are = input.read;
  as_they_are.to_crs.clear();
  Extent own;
  read(
      input, as_they_are, [&](const Points& part) { own.add(part.x, part.y); }, run);
  const auto& at = lattice.ref.to_world;
  const double along_x = std::abs(at[1]) * (own.east - own.west) / (vertices.east - vertices.west);
  const double along_y =
      std::abs(at[5]) * (own.north - own.south) / (vertices.north - vertices.south);
  const double spacing = part_of_cell * std::min(along_x, along_y);
  if (!(spacing > 0) || !std::isfinite(spacing)) refuse(input, "its lines cover no area");
  return spacing;
}

LatticePoints place_contours(const GridInput& input, const GridRequest& request, Extent& extent,
                             const Run& run) {
  LatticePoints placed;
  PointReadOptions options = read_options(input, request.lattice);
  const PointSource first = read(
      input, options, [&](const Points& part) { extent.add(part.x, part.y); }, run.part(0, 0.2));
  if (first.format == "text" || first.format.starts_with("LAS"))
    refuse(input, "has points; contour lines need a vector layer of lines");
  const Lattice lattice = chosen_lattice(request.lattice, extent, first.crs_wkt);
  options.along_lines = spacing_along_lines(input, lattice, extent, run.part(0.2, 0.3));
  const Breaklines lines = breaklines_on(input, lattice);
  PointBins levels(lattice, {.combine = Combine::median, .plane = false}, lines);
  PointBins heights(lattice, {.plane = request.bin.plane}, lines);
  const Run quiet{run.threads, {}};
  const auto sink = [&](const Points& part) {
    levels.add(part, quiet);
    heights.add(part, quiet);
  };
  placed.source = read(input, options, sink, run.part(0.3, 0.8));
  placed.levels = levels.finish(run.part(0.8, 0.9)).dem;
  placed.binned = heights.finish(run.part(0.9, 1));
  placed.binned.counts.duplicates = 0;  // lines that share a cell
  return placed;
}

void append(Points& all, const Points& part) {
  const auto join = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  join(all.x, part.x);
  join(all.y, part.y);
  join(all.z, part.z);
  join(all.sigma, part.sigma);
  join(all.weight, part.weight);
}

LatticePoints place_scattered(const GridInput& input, const GridRequest& request, Extent& extent,
                              const Run& run) {
  LatticePoints placed;
  std::optional<PointBins> bins;
  if (const auto& like = request.lattice.like)
    bins.emplace(*like, request.bin, breaklines_on(input, *like));
  Points all;  // while the lattice depends on them
  const Run quiet{run.threads, {}};
  const auto sink = [&](const Points& part) {
    extent.add(part.x, part.y);
    if (bins)
      bins->add(part, quiet);
    else
      append(all, part);
  };
  placed.source = read(input, read_options(input, request.lattice), sink, run.part(0, 0.8));
  if (!bins) {
    const Lattice chosen = chosen_lattice(request.lattice, extent, placed.source.crs_wkt);
    bins.emplace(chosen, request.bin, breaklines_on(input, chosen));
    bins->add(all, run.part(0.8, 0.9));
  }
  placed.binned = bins->finish(run.part(0.9, 1));
  return placed;
}

/// Points that all miss the lattice, perhaps because x and y are swapped.
void check_on_lattice(const GridInput& input, const LatticePoints& placed, const Extent& e) {
  if (placed.binned.counts.cells > 0) return;
  const Dem& dem = placed.binned.dem;
  const auto& at = dem.ref.to_world;
  const double east = at[0] + at[1] * dem.size().cols, south = at[3] + at[5] * dem.size().rows;
  const bool swapped = e.south < east && e.north > at[0] && e.west < at[3] && e.east > south;
  refuse(input,
         fmt::format("none of its {} points lies on the lattice: they cover x {:.10g} to {:.10g}, "
                     "y {:.10g} to {:.10g}; the lattice x {:.10g} to {:.10g}, y {:.10g} to "
                     "{:.10g}{}",
                     placed.source.points, e.west, e.east, e.south, e.north, at[0], east, south,
                     at[3], swapped ? "; with x and y swapped they would lie there" : ""),
         swapped ? "x_field" : "");
}

std::vector<ClosedOff> closed_off(const Dem& dem) {
  const Mask closed = cells_closed_off(dem.known, dem.breaks);
  if (count(closed) == 0) return {};
  Dem others = dem;
  for (std::size_t i = 0; i < closed.cells().size(); ++i)
    others.known.cells()[i] = !closed.cells()[i];
  std::vector<ClosedOff> areas;
  const auto& at = dem.ref.to_world;
  for (const Hole& hole : find_holes(others)) {
    const Box& box = hole.box;
    const double col = box.col + (box.cols - 1) / 2., row = box.row + (box.rows - 1) / 2.;
    areas.push_back(
        {hole.cells, at[0] + at[1] * col + at[2] * row, at[3] + at[4] * col + at[5] * row});
  }
  return areas;
}

}  // namespace

bool has_contours(const GridInput& input) {
  return input.contours || std::holds_alternative<std::vector<ContourLine>>(input.elevations);
}

std::string default_grid_method(bool contours) {
  return std::string(contours ? default_contour_method() : default_fill_method());
}

void check(const GridInput& input, const GridRequest& request) {
  if (input.contours && std::holds_alternative<Points>(input.elevations))
    throw std::invalid_argument("contours: points in memory are no contour lines");
  check_options(input.read);
  check_options(request.bin);
  check_options(request.gridding);
  check_lattice(input, request.lattice);
  if (has_contours(input) && request.bin.outliers > 0)
    throw std::invalid_argument("outliers is for points, and not for contours");
  if (!request.fill) return;
  request.method.check();
  if (has_breaklines(input)) check_honours_breaklines(*request.method.method);
}

LatticePoints place_points(const GridInput& input, const GridRequest& request, const Run& run) {
  check(input, request);
  Extent extent;
  LatticePoints placed = has_contours(input) ? place_contours(input, request, extent, run)
                                             : place_scattered(input, request, extent, run);
  check_on_lattice(input, placed, extent);
  placed.lattice_from = lattice_from(request.lattice);
  if (has_breaklines(input)) placed.closed_off = closed_off(placed.binned.dem);
  return placed;
}

Gridded fill_between(LatticePoints& points, const GridRequest& request, const Run& run) {
  const FillMethod& method = *request.method.method;
  // Contour lines by their own method have their levels as bounds. All else goes through points.
  if (!points.levels.z.empty() && method.fill_lines)
    return {method.fill_lines(points.levels, points.binned.dem.z, request.method.settings, run),
            {}};
  if (!request.bin.plane) points.binned.off_centre.clear();
  return fill_points(points.binned, request.method, request.gridding, run);
}

GridResult grid_points(const GridInput& input, const GridRequest& request, const Run& run) {
  GridResult result;
  result.points = place_points(input, request, run.part(0, request.fill ? 0.4 : 1));
  Gridded gridded;
  if (request.fill) gridded = fill_between(result.points, request, run.part(0.4, 1));
  result.dem = std::move(result.points.binned.dem);
  if (request.fill) {
    result.dem.z = std::move(gridded.filled.z);
    result.dem.known = Mask(result.dem.size(), 1);
  }
  set_row_spacing(result.dem);
  result.sigma = std::move(gridded.filled.sigma);
  result.misfit = gridded.misfit;
  result.report = std::move(gridded.filled.report);
  result.contour_lines = gridded.filled.contour_lines;
  return result;
}

}  // namespace dem
