// dem info: what a file holds.

#include <algorithm>
#include <cmath>

#include "dem/holes.h"
#include "dem/io/geodesy.h"
#include "dem/io/polygons.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string holes;
  ReadOptions read;
};

/// The name in PROJCS["WGS 84 / UTM zone 11N", ...].
std::string crs_name(const std::string& wkt) {
  const auto begin = wkt.find('"'), end = wkt.find('"', begin + 1);
  return end == std::string::npos ? "" : wkt.substr(begin + 1, end - begin - 1);
}

struct Facts {
  const DemFile& file;
  VoidSummary voids;
  double low_m = NAN, high_m = NAN;
  std::vector<Spacing> rows;  // cell size, north to south
  double crs_dx = 0, crs_dy = 0;
  bool geographic = false;
};

Facts gather(const DemFile& file) {
  const Dem& dem = file.dem;
  Facts facts{file, void_summary(dem.known), NAN, NAN, spacing_by_row(dem.ref, dem.size())};
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i) {
    if (!dem.known.cells()[i]) continue;
    const double z = dem.z.cells()[i];
    facts.low_m = std::fmin(facts.low_m, z);
    facts.high_m = std::fmax(facts.high_m, z);
  }
  const auto& w = dem.ref.to_world;
  facts.crs_dx = std::hypot(w[1], w[4]);
  facts.crs_dy = std::hypot(w[2], w[5]);
  facts.geographic = is_geographic(dem.ref);
  return facts;
}

const std::string& type_name(CellType type) { return cell_type_names()[std::size_t(type)]; }

Json as_json(const Facts& f) {
  const auto& source = f.file.source;
  const Size size = f.file.dem.size();
  Json evidence = Json::array();
  for (const auto& e : source.evidence)
    evidence.push_back({{"what", e.what}, {"cells", e.cells}, {"used", e.used}, {"why", e.why}});
  return {{"path", source.path},
          {"format", source.format},
          {"type", type_name(source.type)},
          {"cols", size.cols},
          {"rows", size.rows},
          {"registration", source.node_registered ? "node" : "area"},
          {"crs", crs_name(f.file.dem.ref.crs_wkt)},
          {"geographic", f.geographic},
          {"cell_m",
           {{"north", {f.rows.front().dx_m, f.rows.front().dy_m}},
            {"middle", {f.rows[f.rows.size() / 2].dx_m, f.rows[f.rows.size() / 2].dy_m}},
            {"south", {f.rows.back().dx_m, f.rows.back().dy_m}}}},
          {"cell_crs", {f.crs_dx, f.crs_dy}},
          {"vertical_datum", source.vertical_datum},
          {"nodata", source.nodata ? Json(*source.nodata) : Json()},
          {"nodata_evidence", evidence},
          {"unknown_cells", f.voids.cells},
          {"unknown_share", double(f.voids.cells) / double(size.cells())},
          {"voids", f.voids.voids},
          {"largest_void_cells", f.voids.largest},
          {"border_voids", f.voids.border_voids},
          {"border_void_cells", f.voids.border_cells},
          {"low_m", f.low_m},
          {"high_m", f.high_m}};
}

std::string as_text(const Facts& f) {
  const auto& source = f.file.source;
  const Size size = f.file.dem.size();
  const auto& middle = f.rows[f.rows.size() / 2];
  const std::string crs = crs_name(f.file.dem.ref.crs_wkt);
  std::string text = source.path + "\n";
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("  {:<15} {}\n", name, value);
  };
  line("size", fmt::format("{} x {} cells, {} {}", size.cols, size.rows, source.format,
                           type_name(source.type)));
  line("registration", source.node_registered ? "node: cells are samples, edges are shared by tiles"
                                              : "area: a cell stands for its rectangle");
  line("CRS", crs.empty() ? "none; units are taken as metres" : crs);
  line("cell", fmt::format("{:.6g} x {:.6g} {}", f.crs_dx, f.crs_dy,
                           f.geographic ? "degrees" : "CRS units"));
  line("cell in metres",
       fmt::format("{:.2f} x {:.2f} in the middle row{}", middle.dx_m, middle.dy_m,
                   f.geographic ? fmt::format(", {:.2f} to {:.2f} wide from north to south",
                                              f.rows.front().dx_m, f.rows.back().dx_m)
                                : ""));
  line("vertical datum", source.vertical_datum.empty() ? "not stated" : source.vertical_datum);
  line("heights",
       std::isnan(f.low_m) ? "none known" : fmt::format("{:.6g} to {:.6g} m", f.low_m, f.high_m));
  line("unknown", fmt::format("{} cells, {}", grouped(f.voids.cells),
                              percent_of(f.voids.cells, size.cells())));
  if (f.voids.cells > 0)
    line("voids", fmt::format("{}, largest {} cells; {} touch the border ({} cells)",
                              grouped(f.voids.voids), grouped(f.voids.largest),
                              grouped(f.voids.border_voids), grouped(f.voids.border_cells)));
  if (source.evidence.empty()) line("nodata signs", "none found");
  for (const auto& e : source.evidence)
    line(&e == &source.evidence.front() ? "nodata signs" : "",
         fmt::format("{:<24} {:>12} cells  {}: {}", e.what, grouped(e.cells),
                     e.used ? "unknown" : "kept", e.why));
  return text;
}

int info(const Options& options, Shell& shell) {
  if (!options.holes.empty()) {
    if (options.files.size() > 1)
      throw std::invalid_argument("--holes takes the voids of one FILE; there are " +
                                  std::to_string(options.files.size()));
    check_writable(options.holes, shell.overwrite);
  }
  const Run run = shell.run();
  Json files = Json::array();
  std::string text;
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    const double n = double(options.files.size());
    const DemFile file =
        read_dem(options.files[i], options.read, run.part(double(i) / n, double(i + 1) / n));
    const Facts facts = gather(file);
    if (!options.holes.empty())
      write_holes(options.holes, find_holes(file.dem, facts.rows), file.dem.known, file.dem.ref,
                  shell.overwrite);
    files.push_back(as_json(facts));
    if (i > 0) text += '\n';
    text += as_text(facts);
  }
  shell.print({{"files", files}}, text);
  return kDone;
}

}  // namespace

void add_info(Program& program, Shell& shell) {
  const auto options = std::make_shared<Options>();
  Command& verb = program.add(
      "info", kEveryday, "Show what a file holds: size, cells, nodata, voids, heights",
      "  dem info N36E008.hgt\n"
      "  dem info a.tif b.tif --json\n"
      "  dem info N36E008.hgt --holes voids.gpkg   # the voids as polygons, with their sizes\n"
      "  dem info sea.tif --nodata 0               # what the voids are if 0 means nodata");
  verb.work = [options, &shell] { return info(*options, shell); };
  verb.argument("FILE", options->files, "Elevation files, in any format that GDAL opens")
      .kind("raster")
      .must_be_given();
  verb.option("--holes", options->holes, "FILE.gpkg",
              "Also write the voids as polygons with their area, the relief of their edge and more")
      .kind("new vector");
  add_read_options(verb, options->read);
}

}  // namespace dem::app
