// dem grid: scattered points to a DEM.

#include <algorithm>
#include <chrono>
#include <optional>

#include "dem/gridding.h"
#include "dem/io/lattices.h"
#include "dem/io/methods.h"
#include "dem/io/point_files.h"
#include "dem/io/polygons.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string points, out, sigma, breaklines;
  std::string like, bounds, cell;
  std::string method;  // "": chosen by what the points are
  std::vector<std::string> set;
  bool nodes = false, snap = false, no_fill = false, contours = false;
  PointReadOptions read;
  BinOptions bin;
  GriddingOptions gridding;
  WriteOptions write;
};

void check_honours_breaklines(const FillMethod& method) {
  if (method.traits.honours_breaklines) return;
  std::vector<std::string> others;
  for (const FillMethod& m : all_fill_methods())
    if (m.traits.honours_breaklines) others.push_back(m.name);
  throw std::invalid_argument(fmt::format("--breaklines: method {} knows none; these do: {}",
                                          method.name, fmt::join(others, ", ")));
}

ChosenMethod choose(const Options& o) {
  ChosenMethod chosen = find_method(all_fill_methods(), o.method);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (!o.sigma.empty()) chosen.settings.emplace_back("sigma", "law");
  if (!o.breaklines.empty() && !o.no_fill) check_honours_breaklines(*chosen.method);
  chosen.check();
  if (!o.sigma.empty() && !chosen.gives_sigma())
    throw std::invalid_argument("sigma: method " + o.method + " gives no standard deviation");
  return chosen;
}

void check_options(const Options& o) {
  if (!o.like.empty() && !(o.bounds.empty() && o.cell.empty() && o.read.to_crs.empty() && !o.nodes))
    throw std::invalid_argument(
        "--like says it all: no --bounds, --cell, --nodes or --to-crs beside it");
  if (!o.bounds.empty() && o.cell.empty())
    throw std::invalid_argument("--bounds needs --cell, e.g. --cell 30m");
  if (o.nodes && o.bounds.empty()) throw std::invalid_argument("--nodes is for --bounds");
  if (o.no_fill && !o.sigma.empty())
    throw std::invalid_argument("--no-fill leaves nothing to be uncertain about: no --sigma");
  if (o.contours && o.like.empty() && o.cell.empty())
    throw std::invalid_argument("--contours needs --cell, e.g. --cell 30m, or --like");
  if (o.contours && o.bin.outliers > 0)
    throw std::invalid_argument("--reject-outliers is for points, not for --contours");
  if (!o.bounds.empty()) parse_bounds(o.bounds);
  if (!o.cell.empty()) parse_cell_size(o.cell);
}

char parse_delimiter(const std::string& text) {
  if (text == "tab" || text == "\\t") return '\t';
  if (text == "space") return ' ';
  if (text.size() == 1) return text[0];
  refuse("--delimiter", text, "one character, tab or space");
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

struct Read {
  PointSource source;
  Binned binned;
  Dem lines;  // levels of contour lines, in the cells that they pass
  Extent extent;
  std::string lattice_from;
};

/// The lattice, when it is known before the points are.
std::optional<Lattice> given_lattice(const Options& o, const Run& run) {
  if (o.like.empty()) return {};
  const Dem like = read_dem(o.like, {}, run).dem;
  return Lattice{like.ref, like.size(), like.spacing};
}

/// The lattice, once the extent of the points and their system are known.
Lattice chosen_lattice(const Options& o, const Extent& extent, const std::string& crs) {
  if (o.cell.empty()) return lattice_for(extent, crs);
  const Bounds bounds = o.bounds.empty()
                            ? Bounds{extent.west, extent.south, extent.east, extent.north}
                            : parse_bounds(o.bounds);
  if (!(bounds.west < bounds.east && bounds.south < bounds.north))
    throw std::invalid_argument("the points cover no area; give --bounds");
  return lattice_over(bounds, parse_cell_size(o.cell), crs, o.nodes || o.bounds.empty());
}

Breaklines breaklines_on(const Options& o, const Lattice& lattice) {
  if (o.breaklines.empty()) return {};
  Breaklines lines = read_breaklines(o.breaklines, lattice.ref, lattice.size);
  if (std::ranges::all_of(lines.breaks().cells(), [](auto b) { return b == 0; }))
    throw IoError(o.breaklines, "none of its lines passes between two cells of the lattice");
  return lines;
}

/// Points so close along contour lines that the lines cross no cell unseen; `vertices` has what a
/// first reading found, in the lattice's system.
double spacing_along_lines(const Options& o, const Lattice& lattice, const Extent& vertices,
                           const Run& run) {
  constexpr double part_of_cell = 0.4;
  PointReadOptions as_they_are = o.read;
  as_they_are.to_crs.clear();
  Extent own;
  read_points(
      o.points, as_they_are, [&](const Points& part) { own.add(part.x, part.y); }, run);
  const auto& at = lattice.ref.to_world;
  const double along_x = std::abs(at[1]) * (own.east - own.west) / (vertices.east - vertices.west);
  const double along_y =
      std::abs(at[5]) * (own.north - own.south) / (vertices.north - vertices.south);
  const double spacing = part_of_cell * std::min(along_x, along_y);
  if (!(spacing > 0) || !std::isfinite(spacing)) throw IoError(o.points, "its lines cover no area");
  return spacing;
}

/// Contour lines on a lattice: each cell that a line passes has its level, and a height at its
/// centre.
Read read_contours(const Options& o, const Run& run) {
  Read read;
  PointReadOptions options = o.read;
  auto lattice = given_lattice(o, run.part(0, 0.05));
  if (lattice && !lattice->ref.crs_wkt.empty()) options.to_crs = lattice->ref.crs_wkt;
  Extent vertices;
  const PointSource first = read_points(
      o.points, options, [&](const Points& part) { vertices.add(part.x, part.y); },
      run.part(0.05, 0.2));
  if (first.format == "text" || first.format.starts_with("LAS"))
    throw IoError(o.points, "has points; --contours needs a vector layer of lines");
  if (!lattice) lattice = chosen_lattice(o, vertices, first.crs_wkt);
  options.along_lines = spacing_along_lines(o, *lattice, vertices, run.part(0.2, 0.3));
  const Breaklines lines = breaklines_on(o, *lattice);
  PointBins levels(*lattice, {.combine = Combine::median, .plane = false}, lines);
  PointBins heights(*lattice, {.plane = o.bin.plane}, lines);
  const Run quiet{run.threads, {}};
  const auto sink = [&](const Points& part) {
    levels.add(part, quiet);
    heights.add(part, quiet);
  };
  read.source = read_points(o.points, options, sink, run.part(0.3, 0.8));
  read.extent = vertices;
  read.lattice_from = o.like.empty() ? "as asked for" : "as " + o.like;
  read.lines = levels.finish(run.part(0.8, 0.9)).dem;
  read.binned = heights.finish(run.part(0.9, 1));
  read.binned.counts.duplicates = 0;  // lines that share a cell
  return read;
}

/// Reads the points into bins. They are kept in memory only while the lattice depends on them.
Read read_into_bins(const Options& o, const Run& run) {
  Read read;
  PointReadOptions options = o.read;
  auto lattice = given_lattice(o, run.part(0, 0.05));
  if (lattice && !lattice->ref.crs_wkt.empty()) options.to_crs = lattice->ref.crs_wkt;
  std::optional<PointBins> bins;
  if (lattice) bins.emplace(*lattice, o.bin, breaklines_on(o, *lattice));
  Points all;
  const Run quiet{run.threads, {}};
  const auto sink = [&](const Points& part) {
    read.extent.add(part.x, part.y);
    if (bins)
      bins->add(part, quiet);
    else
      append(all, part);
  };
  read.source = read_points(o.points, options, sink, run.part(0.05, 0.8));
  if (!bins) {
    const Lattice chosen = chosen_lattice(o, read.extent, read.source.crs_wkt);
    bins.emplace(chosen, o.bin, breaklines_on(o, chosen));
    bins->add(all, run.part(0.8, 0.9));
  }
  read.lattice_from = !o.like.empty()     ? "as " + o.like
                      : !o.bounds.empty() ? "as asked for"
                      : !o.cell.empty()   ? "bounds from the points"
                                          : "cells of half the points' mean distance";
  read.binned = bins->finish(run.part(0.9, 1));
  return read;
}

/// Points that miss the lattice: all of them, and the wrong way round?
void check_on_lattice(const Options& o, const Read& read) {
  const Dem& dem = read.binned.dem;
  if (read.binned.counts.cells > 0) return;
  const auto& at = dem.ref.to_world;
  const Extent& e = read.extent;
  const double east = at[0] + at[1] * dem.size().cols, south = at[3] + at[5] * dem.size().rows;
  const bool swapped = e.south < east && e.north > at[0] && e.west < at[3] && e.east > south;
  throw IoError(
      o.points,
      fmt::format(
          "none of its {} points lies on the lattice: they cover x {:.10g} to {:.10g}, y "
          "{:.10g} to {:.10g}; the lattice x {:.10g} to {:.10g}, y {:.10g} to {:.10g}{}",
          read.source.points, e.west, e.east, e.south, e.north, at[0], east, south, at[3],
          swapped ? "; with x and y swapped they would lie there (--x-field, --y-field)" : ""));
}

std::string plural(std::size_t n, const char* what) {
  return fmt::format("{} {}{}", grouped(n), what, n == 1 ? "" : "s");
}

/// No planet has such heights in metres.
constexpr double kAbsurd_m = 30000;

std::size_t count_absurd(const Dem& dem) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
    n += dem.known.cells()[i] && std::abs(double(dem.z.cells()[i])) > kAbsurd_m;
  return n;
}

void say_what_was_read(Options& o, const Read& read, Shell& shell) {
  const BinCounts& n = read.binned.counts;
  const Dem& dem = read.binned.dem;
  for (const auto& note : read.source.notes) shell.say("{}", note);
  if (read.source.crs_wkt.empty()) shell.say("no coordinate system: units are taken as metres");
  shell.say("lattice {} x {}, cells of {:.6g} x {:.6g} m ({})", dem.size().cols, dem.size().rows,
            dem.spacing.dx_m, dem.spacing.dy_m, read.lattice_from);
  if (read.source.without_z > 0)
    shell.say("{} without a position or elevation left out", plural(read.source.without_z, "row"));
  if (read.source.other_class > 0)
    shell.say("{} of other classes left out", plural(read.source.other_class, "point"));
  if (n.outside > 0) shell.say("{} outside the lattice left out", plural(n.outside, "point"));
  if (n.parted > 0)
    shell.say("{} parted from their cell's centre by a breakline left out",
              plural(n.parted, "point"));
  if (const std::size_t absurd = count_absurd(dem); absurd > 0)
    shell.say(
        "warning: {} with elevations beyond {:g} m; --reject-outliers or --nodata leaves such out",
        plural(absurd, "cell"), kAbsurd_m);
  if (n.duplicates > 0)
    shell.say("{} at the place of another with another elevation: combined by {}",
              plural(n.duplicates, "point"), field(o.bin, "combine").text());
  if (n.outliers > 0) shell.say("{} taken for outliers and left out", plural(n.outliers, "cell"));
  shell.say("{} in {} of {} cells ({})", plural(n.points - n.outside, "point"), grouped(n.cells),
            grouped(dem.size().cells()), percent_of(n.cells, dem.size().cells()));
}

Json as_json(const Read& read) {
  const BinCounts& n = read.binned.counts;
  const Dem& dem = read.binned.dem;
  return {{"format", read.source.format},
          {"notes", read.source.notes},
          {"crs", crs_name(dem.ref.crs_wkt)},
          {"cols", dem.size().cols},
          {"rows", dem.size().rows},
          {"cell", {std::abs(dem.ref.to_world[1]), std::abs(dem.ref.to_world[5])}},
          {"cell_m", {dem.spacing.dx_m, dem.spacing.dy_m}},
          {"lattice_from", read.lattice_from},
          {"points", n.points},
          {"without_z", read.source.without_z},
          {"other_class", read.source.other_class},
          {"outside", n.outside},
          {"parted", n.parted},
          {"combined", n.combined},
          {"duplicates", n.duplicates},
          {"outlier_cells", n.outliers},
          {"known_cells", n.cells}};
}

void write_outputs(const Options& o, const Dem& dem, const Raster<float>& sigma, Shell& shell,
                   const Run& run) {
  WriteOptions write;
  write.overwrite = shell.overwrite;
  Source source;
  source.node_registered = o.nodes;
  if (!o.sigma.empty()) {
    Dem of_sigma = dem;
    of_sigma.z = sigma;
    Source described = source;
    described.band_description = "standard deviation of the elevation in metres";
    write_dem(o.sigma, of_sigma, described, write, run.part(0, 0.4));
  }
  write = o.write;
  write.overwrite = shell.overwrite;
  if (holds_metadata(o.out, write.format))
    write.metadata = {{"DEM_METHOD", o.no_fill ? "points only" : o.method},
                      {"DEM_VERSION", DEM_VERSION}};
  write_dem(o.out, dem, source, write, run.part(0.4, 1));
}

/// Says where breaklines close off cells without a point.
std::size_t say_what_is_closed_off(const Dem& dem, Shell& shell) {
  const Mask closed = cells_closed_off(dem.known, dem.breaks);
  const std::size_t cells = count(closed);
  if (cells == 0) return 0;
  Dem others = dem;
  for (std::size_t i = 0; i < closed.cells().size(); ++i)
    others.known.cells()[i] = !closed.cells()[i];
  const std::vector<Hole> areas = find_holes(others);
  constexpr std::size_t named = 3;
  for (std::size_t i = 0; i < std::min(named, areas.size()); ++i) {
    const Box& box = areas[i].box;
    const auto& at = dem.ref.to_world;
    const double col = box.col + (box.cols - 1) / 2., row = box.row + (box.rows - 1) / 2.;
    shell.say(
        "breaklines close off {} around x {:.10g}, y {:.10g} without a point: filled as though "
        "there were no line",
        plural(areas[i].cells, "cell"), at[0] + at[1] * col + at[2] * row,
        at[3] + at[4] * col + at[5] * row);
  }
  if (areas.size() > named) shell.say("... and {} more such areas", areas.size() - named);
  return cells;
}

/// Contour lines by their own method have their levels as bounds; all else goes through its points.
Gridded fill(const Options& o, const Read& read, const ChosenMethod& method, const Run& run) {
  if (!o.contours || !method.method->fill_lines)
    return fill_points(read.binned, method, o.gridding, run);
  return {method.method->fill_lines(read.lines, read.binned.dem.z, method.settings, run), {}};
}

int grid(Options& o, Shell& shell) {
  check_options(o);
  o.bin.plane = !o.snap;
  if (o.method.empty()) o.method = o.contours ? default_contour_method() : default_fill_method();
  const ChosenMethod method = choose(o);
  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  check_writable(o.out, write);
  if (!o.sigma.empty()) check_writable(o.sigma, shell.overwrite);

  const Run run = shell.run();
  Read read = o.contours ? read_contours(o, run.part(0, 0.4)) : read_into_bins(o, run.part(0, 0.4));
  check_on_lattice(o, read);
  say_what_was_read(o, read, shell);
  Json json = as_json(read);
  json["output"] = o.out;

  Dem& dem = read.binned.dem;
  Raster<float> sigma;
  if (!o.no_fill) {
    if (o.snap) read.binned.off_centre.clear();
    if (!o.breaklines.empty()) json["closed_off"] = say_what_is_closed_off(dem, shell);
    const auto start = std::chrono::steady_clock::now();
    Gridded gridded = fill(o, read, method, run.part(0.4, 0.9));
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (method.method->traits.for_contours && !gridded.filled.contour_lines)
      shell.say("{}: the cells with points are no contour lines; the spline filled the rest",
                o.method);
    dem.z = std::move(gridded.filled.z);
    dem.known = Mask(dem.size(), 1);
    sigma = std::move(gridded.filled.sigma);
    shell.say(
        "filled by {} in {:.2f} s; the surface misses the points by {:.3g} m (RMS), {:.3g} m "
        "at most",
        o.method, seconds, gridded.misfit.rms_m, gridded.misfit.max_m);
    json["method"] = o.method;
    json["seconds"] = seconds;
    json["misfit_rms_m"] = gridded.misfit.rms_m;
    json["misfit_max_m"] = gridded.misfit.max_m;
  }
  write_outputs(o, dem, sigma, shell, run.part(0.9, 1));
  shell.say("wrote {}", o.out);
  shell.print(json, "");
  return kDone;
}

void add_point_options(Command& verb, Options& o) {
  verb.heading("Reading points");
  const auto field = [&](const char* name, std::string& value, const char* doc) {
    verb.option(name, value, "NAME", doc);
  };
  field("--x-field", o.read.x_field,
        "Column of x, by its name or its number from 1 (found by its usual names)");
  field("--y-field", o.read.y_field, "Column of y");
  field("--z-field", o.read.z_field, "Column or attribute of the elevation in metres");
  field("--sigma-field", o.read.sigma_field, "Column of the standard error of the elevation");
  field("--weight-field", o.read.weight_field, "Column of weights");
  field("--position-field", o.read.position_field, "Column of MGRS, UTM or DMS positions");
  verb.option_read_by(
      "--delimiter", [&o](const std::string& text) { o.read.delimiter = parse_delimiter(text); },
      "CHAR", "Character between columns, tab or space (found in the first line)");
  verb.option("--layer", o.read.layer, "NAME", "Layer of a vector file that has several layers");
  verb.option("--class", o.read.classes, "N,N",
              "LAS classes to read, for example 2,8 (all of them); may be repeated")
      .by_commas()
      .within(0, 255);
  verb.option("--nodata", o.read.nodata, "VALUE", "Elevation that means nodata");
  add_crs_option(
      verb, "--crs", o.read.crs,
      "Coordinate system of the points, for example EPSG:25832; PROJ strings and WKT too");
}

void add_lattice_options(Command& verb, Options& o) {
  verb.heading("Lattice (chosen by the density of the points)");
  verb.option("--like", o.like, "RASTER", "Use the lattice of this raster").kind("raster");
  verb.option("--bounds", o.bounds, "W,S,E,N", "Outer edges of the cells");
  verb.option("--cell", o.cell, "SIZE", "Cell size: 30 or 30m, 1s (arc second), 0.001deg");
  verb.flag("--nodes", o.nodes, "--bounds are the centres of the outer cells");
  add_crs_option(verb, "--to-crs", o.read.to_crs,
                 "Coordinate system of the lattice (that of the points)");
}

}  // namespace

void add_grid(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "grid", kEveryday, "Make a DEM from scattered points or contour lines",
      "  dem grid soundings.csv sea.tif              # cell size from the density of the points\n"
      "  dem grid map.gpkg dem.tif --contours --cell 10m --z-field height\n"
      "  dem grid lidar.las ground.tif --class 2 --cell 1m --combine median\n"
      "  zcat p.xyz.gz | dem grid - dem.tif --crs EPSG:4326 --to-crs EPSG:32632 --cell 30m");
  verb.work = [o, &shell] { return grid(*o, shell); };
  verb.argument("POINTS", o->points,
                "Points: CSV, XYZ, TSV (- for standard input), LAS or any vector format of OGR")
      .kind("points")
      .must_be_given();
  verb.argument("OUT", o->out, "The DEM, in the format of its extension")
      .kind("new raster")
      .must_be_given();
  verb.option(
          "-m,--method", o->method, "NAME",
          "Fill method between the points, see `dem methods` (spline; contours with --contours)")
      .suggest(names_and_presets(all_fill_methods()));
  verb.flag("--contours", o->contours,
            "POINTS are contour lines, and no terraces may appear between them");
  add_set_option(verb, o->set, "method");
  verb.option("--breaklines", o->breaklines, "LAYER",
              "Lines and polygons across which the surface may jump, such as cliffs and dams")
      .kind("vector");
  verb.option_read_by(
          "--combine", [o](const std::string& name) { field(o->bin, "combine").set(name); }, "HOW",
          "How the points of one cell become one height")
      .one_of(field(o->bin, "combine").choices())
      .show_default("mean");
  verb.option("--reject-outliers", o->bin.outliers, "TIMES",
              "Drop cells more than TIMES robust standard deviations from their neighbours, for "
              "example 10")
      .within(1, 1e9);
  verb.flag("--snap", o->snap, "Move each point to the centre of its cell");
  verb.option("--passes", o->gridding.passes, "N",
              "Number of correction passes that pull the surface to points off cell centres")
      .within(0, 100)
      .show_default();
  verb.flag("--no-fill", o->no_fill,
            "Write only the cells that hold points; all others are nodata");
  verb.option("--sigma", o->sigma, "FILE", "Also write the standard error of each cell in metres")
      .kind("new raster");
  add_lattice_options(verb, *o);
  add_point_options(verb, *o);
  add_write_options(verb, o->write);
}

}  // namespace dem::app
