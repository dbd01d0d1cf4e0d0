// dem fill: fill the holes of a DEM.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "dem/baselines.h"
#include "dem/holes.h"
#include "verbs.h"

namespace dem::app {
namespace {

const std::vector<std::pair<std::string, CellType>> kTypes{
    {"int8", CellType::int8},       {"uint8", CellType::uint8},    {"int16", CellType::int16},
    {"uint16", CellType::uint16},   {"int32", CellType::int32},    {"uint32", CellType::uint32},
    {"float32", CellType::float32}, {"float64", CellType::float64}};

struct Options {
  std::string in, out, sigma;
  std::optional<int> realisation;
  std::optional<std::uint64_t> seed;
  std::string method{default_fill_method()};
  std::vector<std::string> set;
  bool inner_only = false;
  ReadOptions read;
  WriteOptions write;
};

/// What was done, for the report.
struct Outcome {
  std::size_t unknown = 0, filled = 0, left_at_border = 0, left = 0;
  VoidSummary voids;
  bool known_kept = true;  // every known cell came back bit for bit
  double seconds = 0;
  std::vector<Figure> figures;
  Raster<float> sigma;
};

/// A DEM of one known cell: cheap to fill, so that bad settings show before long work.
Dem one_cell() { return {Raster<float>({1, 1}), Mask({1, 1}, 1), {}, {}}; }

/// Adds a setting that an option of its own stands for, unless it is among the settings already.
void add_setting(ChosenMethod& chosen, const std::string& name, const std::string& value,
                 const std::string& option) {
  if (std::ranges::find(chosen.method->fields, name, &FieldInfo::name) ==
      chosen.method->fields.end())
    throw std::invalid_argument(
        fmt::format("{}: method {} has no setting {}", option, chosen.method->name, name));
  if (std::ranges::find(chosen.settings, name, &Settings::value_type::first) ==
      chosen.settings.end())
    chosen.settings.emplace_back(name, value);
}

ChosenMethod choose(const Options& o) {
  ChosenMethod chosen = find_method(all_fill_methods(), o.method);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (!o.sigma.empty()) add_setting(chosen, "sigma", "law", "--sigma");
  if (o.realisation)
    add_setting(chosen, "realisation", std::to_string(*o.realisation), "--realisation");
  if (o.seed) add_setting(chosen, "seed", std::to_string(*o.seed), "--seed");
  const Filled trial = chosen.method->fill(one_cell(), chosen.settings, {});
  if (!o.sigma.empty() && trial.sigma.empty())
    throw std::invalid_argument("sigma: method " + chosen.method->name +
                                " gives no standard deviation");
  return chosen;
}

/// Fills the unknown cells of `dem` in place.
Outcome fill_in_place(Dem& dem, const ChosenMethod& chosen, bool inner_only, const Run& run) {
  Outcome out;
  out.voids = void_summary(dem.known);
  out.unknown = out.voids.cells;
  if (out.unknown == 0) return out;

  const auto start = std::chrono::steady_clock::now();
  Filled filled = chosen.method->fill(dem, chosen.settings, run);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const Mask inner = inner_only ? inner_voids(dem.known) : Mask();
  const auto z = dem.z.cells();
  const auto known = dem.known.cells();
  for (std::size_t i = 0; i < z.size(); ++i) {
    const float value = filled.z.cells()[i];
    if (known[i]) {
      out.known_kept &= std::memcmp(&z[i], &value, sizeof value) == 0;
    } else if (inner_only && !inner.cells()[i]) {
      ++out.left_at_border;
    } else if (!std::isfinite(value)) {
      ++out.left;
    } else {
      z[i] = value;
      known[i] = 1;
      ++out.filled;
    }
  }
  out.figures = std::move(filled.report);
  out.sigma = std::move(filled.sigma);
  return out;
}

std::string settings_text(const Settings& settings) {
  std::string text;
  for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
  return text;
}

/// What became of the known cells: in another type they need not be the same.
std::string known_cells(const Options& o, const Outcome& out, CellType type) {
  if (!out.known_kept) return "CHANGED";
  if (!o.write.type || *o.write.type == type) return "unchanged";
  return "written as " +
         std::ranges::find(kTypes, *o.write.type, &decltype(kTypes)::value_type::second)->first;
}

void report(const Options& o, const ChosenMethod& chosen, const Outcome& out, CellType type,
            Shell& shell) {
  if (out.unknown == 0) {
    shell.say("all cells are known: {} is a copy of {}", o.out, o.in);
  } else {
    std::string left;
    if (o.inner_only)
      left += fmt::format(", {} left in voids at the border", grouped(out.left_at_border));
    if (out.left) left += fmt::format(", {} left unfilled", grouped(out.left));
    shell.say(
        "filled {} of {} unknown cells ({} of {} voids touch the border){}; {}, {:.3f} s; known "
        "cells {}: {}",
        grouped(out.filled), grouped(out.unknown), grouped(out.voids.border_voids),
        grouped(out.voids.voids), left, o.method, out.seconds, known_cells(o, out, type), o.out);
  }
  Json figures = Json::array();
  for (const auto& f : out.figures)
    figures.push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  Json settings = Json::object();
  for (const auto& [key, value] : chosen.settings) settings[key] = value;
  shell.print({{"output", o.out},
               {"method", o.method},
               {"settings", settings},
               {"unknown", out.unknown},
               {"voids", out.voids.voids},
               {"border_voids", out.voids.border_voids},
               {"border_void_cells", out.voids.border_cells},
               {"filled", out.filled},
               {"left_at_border", out.left_at_border},
               {"left", out.left},
               {"known_unchanged", out.known_kept},
               {"seconds", out.seconds},
               {"report", figures}},
              "");
}

int fill(const Options& o, Shell& shell) {
  const ChosenMethod chosen = choose(o);
  check_writable(o.out, shell.overwrite);
  if (!o.sigma.empty()) check_writable(o.sigma, shell.overwrite);

  const Run run = shell.run();
  DemFile file = read_dem(o.in, o.read, run.part(0, 0.2));
  if (count(file.dem.known) == 0)
    throw IoError(o.in, "no known cell; at least one is needed to fill the others");
  const Outcome out = fill_in_place(file.dem, chosen, o.inner_only, run.part(0.2, 0.8));

  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  if (out.unknown > 0 && holds_metadata(o.out, o.write.format))
    write.metadata = {{"DEM_METHOD", o.method},
                      {"DEM_SETTINGS", settings_text(chosen.settings)},
                      {"DEM_VERSION", DEM_VERSION}};
  if (!o.sigma.empty()) {
    Dem sigma = file.dem;
    sigma.z = out.sigma.empty() ? Raster<float>(file.dem.size()) : out.sigma;
    WriteOptions plain;
    plain.overwrite = shell.overwrite;
    Source described;
    described.node_registered = file.source.node_registered;
    described.band_description = "standard deviation of the elevation in metres";
    write_dem(o.sigma, sigma, described, plain, run.part(0.8, 0.85));
  }
  write_dem(o.out, file.dem, file.source, write, run.part(0.85, 1));

  report(o, chosen, out, file.source.type, shell);
  if (!out.known_kept) return kCheckFailed;
  return out.left > 0 ? kUnfilled : kDone;
}

std::string method_names() {
  std::vector<std::string> names;
  for (const auto& m : all_fill_methods()) names.push_back(m.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_write_options(CLI::App& app, WriteOptions& write) {
  const char* group = "Writing";
  app.add_option("--format", write.format, "GDAL driver name, HGT or image; else by extension")
      ->type_name("NAME")
      ->group(group);
  app.add_option_function<std::string>(
         "--type",
         [&write](const std::string& name) {
           for (const auto& [text, type] : kTypes)
             if (text == name) write.type = type;
         },
         "int8 uint8 int16 uint16 int32 uint32 float32 float64; else as IN")
      ->check([](const std::string& name) {
        for (const auto& [text, type] : kTypes)
          if (text == name) return std::string();
        return name +
               " is no cell type; must be int8, uint8, int16, uint16, int32, uint32, float32 or "
               "float64";
      })
      ->type_name("TYPE")
      ->group(group);
  app.add_option_function<double>(
         "--out-nodata", [&write](double v) { write.nodata = v; },
         "the no-data value that OUT declares; else as IN")
      ->type_name("VALUE")
      ->group(group);
}

}  // namespace

void add_fill(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb = add_verb(
      app, shell, "fill", "Fill the holes of a DEM; known cells stay as they are, bit for bit",
      "  dem fill N36E008.hgt filled.hgt\n"
      "  dem fill sparse.tif filled.tif --sigma sigma.tif           # and how sure each cell is\n"
      "  dem fill sparse.tif rough.tif --realisation 1              # as rough as the terrain\n"
      "  dem fill coast.tif filled.tif --method mcmd --inner-only   # fast; not the border's "
      "voids\n"
      "Methods: " +
          method_names() + " (their settings: dem methods NAME)",
      [o, &shell] { return fill(*o, shell); });
  verb->add_option("IN", o->in, "a DEM with holes, anything GDAL opens")->required()->type_name("");
  verb->add_option("OUT", o->out, "the filled DEM; the format follows the extension")
      ->required()
      ->type_name("");
  verb->add_option("-m,--method", o->method, "how to fill, NAME or NAME:PRESET")
      ->type_name("NAME")
      ->capture_default_str();
  verb->add_option("-s,--set", o->set, "a setting of the method; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  verb->add_flag("--inner-only", o->inner_only, "leave voids that touch the border unfilled");
  verb->add_option("--sigma", o->sigma, "also write the standard deviation of each cell, in metres")
      ->type_name("FILE");
  verb->add_option("--realisation", o->realisation,
                   "the K-th random surface through the data, as rough as the terrain")
      ->check(CLI::Range(1, 1000000).description(""))
      ->type_name("K");
  verb->add_option("--seed", o->seed, "of random numbers")->type_name("N");
  add_read_options(*verb, o->read);
  add_write_options(*verb, o->write);
}

}  // namespace dem::app
