// dem grid: scattered points to a DEM.

#include <algorithm>
#include <chrono>

#include "dem/io/grid_points.h"
#include "dem/io/methods.h"
#include "grid_json.h"
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

ChosenMethod choose(const Options& o) {
  ChosenMethod chosen = find_method(all_fill_methods(), o.method);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (!o.sigma.empty()) chosen.settings.emplace_back("sigma", "law");
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
}

char parse_delimiter(const std::string& text) {
  if (text == "tab" || text == "\\t") return '\t';
  if (text == "space") return ' ';
  if (text.size() == 1) return text[0];
  refuse("--delimiter", text, "one character, tab or space");
}

GridInput input_of(const Options& o) { return {o.points, o.contours, o.read, o.breaklines}; }

/// The request. The lattice of --like is there, but has no cells yet.
GridRequest request_of(const Options& o) {
  GridRequest request{{}, o.bin, o.gridding, choose(o), !o.no_fill};
  request.lattice.nodes = o.nodes;
  if (!o.like.empty()) request.lattice.like.emplace();
  if (!o.bounds.empty()) request.lattice.bounds = parse_bounds(o.bounds);
  if (!o.cell.empty()) request.lattice.cell = parse_cell_size(o.cell);
  return request;
}

void read_like(const Options& o, LatticeWish& lattice, const Run& run) {
  if (o.like.empty()) return;
  const Dem like = read_dem(o.like, {}, run).dem;
  lattice.like = Lattice{like.ref, like.size(), like.spacing};
  lattice.like_name = o.like;
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

void say_what_was_read(Options& o, const LatticePoints& read, Shell& shell) {
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
void say_what_is_closed_off(const std::vector<ClosedOff>& areas, Shell& shell) {
  constexpr std::size_t named = 3;
  for (std::size_t i = 0; i < std::min(named, areas.size()); ++i)
    shell.say(
        "breaklines close off {} around x {:.10g}, y {:.10g} without a point: filled as though "
        "there were no line",
        plural(areas[i].cells, "cell"), areas[i].x, areas[i].y);
  if (areas.size() > named) shell.say("... and {} more such areas", areas.size() - named);
}

int grid(Options& o, Shell& shell) {
  check_options(o);
  o.bin.plane = !o.snap;
  if (o.method.empty()) o.method = default_grid_method(o.contours);
  const GridInput input = input_of(o);
  GridRequest request = request_of(o);
  check(input, request);
  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  check_writable(o.out, write);
  if (!o.sigma.empty()) check_writable(o.sigma, shell.overwrite);

  const Run run = shell.run();
  read_like(o, request.lattice, run.part(0, 0.02));
  LatticePoints read = place_points(input, request, run.part(0.02, 0.4));
  say_what_was_read(o, read, shell);
  Json json = as_json(read, read.binned.dem);
  json["output"] = o.out;

  Dem& dem = read.binned.dem;
  Raster<float> sigma;
  if (!o.no_fill) {
    say_what_is_closed_off(read.closed_off, shell);
    if (!o.breaklines.empty()) json["closed_off"] = cells_of(read.closed_off);
    const auto start = std::chrono::steady_clock::now();
    Gridded gridded = fill_between(read, request, run.part(0.4, 0.9));
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (request.method.method->traits.for_contours && !gridded.filled.contour_lines)
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
