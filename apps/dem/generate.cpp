// dem generate: terrain from nothing, or from an image.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "dem/generators.h"
#include "dem/io/drawing.h"
#include "dem/io/geodesy.h"
#include "dem/io/lattices.h"
#include "dem/io/places.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string name;
  std::vector<std::string> files;  // [IMAGE] OUT
  std::string size, cell, crs, origin;
  WriteOptions write;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> set;
  int median = 0;
};

/// "A" or "A<separator>B" as two numbers.
std::pair<double, double> parse_pair(std::string_view option, const std::string& text,
                                     char separator, std::string_view must_be) {
  const auto at = text.find(separator);
  const double first = parse_number(option, text.substr(0, at), must_be);
  if (at == std::string::npos) return {first, first};
  return {first, parse_number(option, text.substr(at + 1), must_be)};
}

Size parse_size(const std::string& text) {
  const auto must_be = "N or WxH, whole numbers from 1 to 1000000, e.g. 1025 or 800x600";
  const auto [cols, rows] = parse_pair("--size", text, 'x', must_be);
  for (const double side : {cols, rows})
    if (side < 1 || side > 1e6 || side != std::floor(side)) refuse("--size", text, must_be);
  return {int(cols), int(rows)};
}

/// "SIZE" or "DXxDY", along x and y.
std::pair<CellSize, CellSize> parse_cell(const std::string& text) {
  const auto size_of = [&](const std::string& part) {
    try {
      return parse_cell_size(part);
    } catch (const std::invalid_argument&) {
      refuse("--cell", text, "SIZE or DXxDY above 0: 30 or 30m, 1s (arc second), 0.001deg");
    }
  };
  const auto x = text.find('x');
  const CellSize first = size_of(text.substr(0, x));
  return {first, x == text.npos ? first : size_of(text.substr(x + 1))};
}

/// The whole Earth, which leaves nothing to choose but the size.
Canvas globe(const Options& o, Size size) {
  for (const auto& [option, text] :
       {std::pair{"--cell", o.cell}, {"--crs", o.crs}, {"--origin", o.origin}})
    if (!text.empty())
      throw std::invalid_argument(
          fmt::format("{} = {}; {} makes the whole Earth in EPSG:4326, so only --size is taken",
                      option, text, o.name));
  return globe_canvas(size);
}

/// A plane as asked for; cells of 30 m from 0,0 on by default.
Canvas plane(const Options& o, Size size) {
  const auto must_be = "X,Y of the north-west cell in the CRS's units, e.g. 305000,4910000";
  if (!o.origin.empty() && o.origin.find(',') == std::string::npos)
    refuse("--origin", o.origin, must_be);
  const auto [x, y] =
      o.origin.empty() ? std::pair{0.0, 0.0} : parse_pair("--origin", o.origin, ',', must_be);
  const std::string cell = o.cell.empty() ? "30" : o.cell;
  const auto [dx, dy] = parse_cell(cell);
  if (dx.unit == CellUnit::metres && dy.unit == CellUnit::metres)
    return plane_canvas(size, {dx.value, dy.value}, x, y, o.crs);
  Canvas canvas = plane_canvas(size, {1, 1}, x, y, o.crs);
  if (dx.unit != dy.unit || !is_geographic(canvas.ref))
    refuse("--cell", cell, "in metres, or both in degrees with a --crs in degrees");
  canvas.ref.to_world[1] = dx.value;
  canvas.ref.to_world[5] = -dy.value;
  canvas.spacing = middle_spacing(canvas.ref, {1, 1});
  return canvas;
}

/// Grey levels of the image that the generator starts from; none when it takes none.
Raster<float> read_image(const Options& o, const Generator& generator, const Run& run) {
  if (o.files.size() > 2)
    throw std::invalid_argument(fmt::format("unexpected argument {}", o.files[2]));
  if (generator.image.empty()) {
    if (o.files.size() == 2)
      throw std::invalid_argument(fmt::format("unexpected argument {}; {} starts from no image",
                                              o.files[1], generator.name));
    return {};
  }
  if (o.files.size() != 2)
    throw std::invalid_argument(fmt::format("{} needs an image: dem generate {} IMAGE OUT ({})",
                                            generator.name, generator.name, generator.image));
  if (is_vector_file(o.files[0])) return {};  // drawn on the canvas later
  ReadOptions grey;
  grey.heights = {0, 1};
  return read_dem(o.files[0], grey, run).dem.z;
}

Size canvas_size(const Options& o, const Generator& generator, const Raster<float>& image) {
  if (!image.empty()) {
    if (!o.size.empty() && parse_size(o.size) != image.size())
      throw std::invalid_argument(
          fmt::format("--size = {}; the image has {} x {} cells, so leave --size out", o.size,
                      image.cols(), image.rows()));
    return image.size();
  }
  if (!o.size.empty()) return parse_size(o.size);
  return generator.globe ? Size{1440, 720} : Canvas{}.size;
}

ChosenGenerator choose(const Options& o) {
  ChosenGenerator chosen = find_generator(o.name);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (o.seed) {
    const auto& fields = chosen.generator->fields;
    if (std::ranges::find(fields, "seed", &FieldInfo::name) == fields.end())
      throw std::invalid_argument("--seed: generator " + chosen.generator->name +
                                  " uses no random numbers");
    chosen.settings.emplace_back("seed", std::to_string(*o.seed));
  }
  return chosen;
}

std::string settings_text(const Settings& settings) {
  std::string text;
  for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
  return text;
}

int generate(const Options& o, Shell& shell) {
  const ChosenGenerator chosen = choose(o);
  const std::string& out = o.files.back();
  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  check_writable(out, write);
  if (!o.size.empty()) parse_size(o.size);
  if (!chosen.generator->globe) check_canvas(plane(o, {1, 1}));
  const Run run = shell.run();
  Drawing drawing{read_image(o, *chosen.generator, run.part(0, 0.1))};
  const Size size = canvas_size(o, *chosen.generator, drawing.grey);
  const Canvas canvas = chosen.generator->globe ? globe(o, size) : plane(o, size);
  check_canvas(canvas);
  if (!chosen.generator->image.empty() && drawing.grey.empty())
    drawing = draw_vectors(o.files[0], canvas);

  const auto start = std::chrono::steady_clock::now();
  Dem dem = chosen.generator->generate(canvas, drawing, chosen.settings, run.part(0.1, 0.7));
  dem.z = median_filter(dem.z, 5, o.median, run.part(0.7, 0.8));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  if (holds_metadata(out, write.format))
    write.metadata = {{"DEM_GENERATOR", o.name},
                      {"DEM_SETTINGS", settings_text(chosen.settings)},
                      {"DEM_VERSION", DEM_VERSION}};
  write_dem(out, dem, {}, write, run.part(0.8, 1));

  const auto [low, high] = std::ranges::minmax(dem.z.cells());
  shell.say("{}: {} x {} cells of {:.4g} x {:.4g} m, heights {:.1f} to {:.1f} m, {:.3f} s: {}",
            o.name, size.cols, size.rows, canvas.spacing.dx_m, canvas.spacing.dy_m, low, high,
            seconds, out);
  Json settings = Json::object();
  for (const auto& [key, value] : chosen.settings) settings[key] = value;
  shell.print({{"output", out},
               {"generator", o.name},
               {"settings", settings},
               {"cols", size.cols},
               {"rows", size.rows},
               {"cell_m", {canvas.spacing.dx_m, canvas.spacing.dy_m}},
               {"low_m", low},
               {"high_m", high},
               {"seconds", seconds}},
              "");
  return kDone;
}

std::string generator_names() {
  std::vector<std::string> names;
  for (const auto& g : generators()) names.push_back(g.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

void add_generate(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "generate", kSynthesize, "Make terrain from a formula, an image or drawn lines",
      "  dem generate noise:foothills range.tif --size 2049 --cell 10 --seed 7\n"
      "  dem generate noise part.tif --size 512 --crs EPSG:32619 --origin 305000,4910000 -s H=0.9\n"
      "  dem generate sketch:wall drawing.png wall.tif --median 2\n"
      "  dem generate skeleton lines.gpkg land.tif --size 800 --origin 305000,4910000");
  verb.notes = "Names: " + generator_names() + "\n(their settings: dem methods NAME)\n";
  verb.work = [o, &shell] { return generate(*o, shell); };
  verb.argument("NAME", o->name, "Name of the generator, NAME or NAME:PRESET")
      .suggest(names_and_presets(generators()))
      .must_be_given();
  verb.argument("FILES", o->files,
                "[IMAGE] OUT: the DEM to write, and before it the image or vector layer that some "
                "generators start from")
      .kind("new raster")
      .must_be_given();
  verb.option("--size", o->size, "N|WxH",
              "Number of columns and rows (1025, or the size of the image)");
  verb.option("--cell", o->cell, "SIZE|DXxDY",
              "Cell size: 30 or 30m; with degrees also 1s (arc second), 0.001deg")
      .show_default("30");
  add_crs_option(verb, "--crs", o->crs, "Coordinate system, for example EPSG:32619");
  verb.option("--origin", o->origin, "X,Y", "Centre of the north-west cell in the units of the CRS")
      .show_default("0,0");
  verb.option("--seed", o->seed, "N",
              "Random seed; the same seed gives the same terrain on every machine");
  add_set_option(verb, o->set, "generator");
  verb.option("--median", o->median, "N",
              "Number of passes of a 5 x 5 median filter over the result")
      .within(0, 100)
      .show_default();
  add_write_options(verb, o->write);
}

}  // namespace dem::app
