#include "common.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <stdexcept>

#include "dem/io/geodesy.h"
#include "dem/outliers.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

HeightRange parse_height_range(const std::string& text) {
  const auto must_be = "LOW,HIGH in metres with LOW < HIGH, for example 0,4800";
  const auto comma = text.find(',');
  HeightRange range{0, 0};
  if (comma != std::string::npos) {
    range.low_m = parse_number("--height-range", text.substr(0, comma), must_be);
    range.high_m = parse_number("--height-range", text.substr(comma + 1), must_be);
  }
  if (!(range.low_m < range.high_m)) refuse("--height-range", text, must_be);
  return range;
}

/// KEY=VALUE.
std::pair<std::string, std::string> parse_pair_of(std::string_view option, const std::string& text,
                                                  std::string_view must_be) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse(option, text, must_be);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

/// The name of a tile, as it stands in the names of .hgt files.
std::string parse_tile(const std::string& text) {
  static const std::regex name("[NSns][0-9]{2}[EWew][0-9]{3}");
  if (!std::regex_match(text, name)) refuse("--tile", text, "the name of a tile such as N36E008");
  return text;
}

}  // namespace

void Shell::add_options(Command& verb) {
  verb.heading("Everywhere");
  verb.flag("--json", json, "Print the result as one JSON object on standard output");
  verb.flag("-q,--quiet", quiet, "Print errors only: no messages and no progress");
  verb.option(
          "--progress", progress, "HOW",
          "How to show progress on standard error: a bar, JSON lines or not at all (auto: a bar "
          "on a terminal)")
      .one_of({"auto", "bar", "json", "none"})
      .show_default();
  verb.option("-j,--threads", threads, "N",
              "Number of threads (0: one per core); the result does not depend on it")
      .within(0, 1024)
      .show_default();
  verb.flag("--overwrite", overwrite, "Replace output files that exist");
}

Run Shell::run() {
  bar_.start(Progress::style_of(progress, quiet));
  return {threads, [this](double part, std::string_view what) { return bar_.report(part, what); }};
}

void Shell::print(const Json& object, std::string_view text) {
  bar_.clear();
  if (json)
    fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace));
  else
    fmt::print("{}", text);
}

void Shell::message(const std::string& line) {
  bar_.clear();
  fmt::print(stderr, "{}\n", line);
}

void add_read_options(Command& command, ReadOptions& options) {
  command.heading("Reading");
  command
      .option("--band", options.band, "N",
              "Band to read, counted from 1 (needed when the file has several bands)")
      .within(1, 65535);
  command.option_read_by(
      "--tile", [&options](const std::string& text) { options.tile = parse_tile(text); }, "N36E008",
      "Name of the .hgt tile, when the name of the file does not contain it");
  command.option("--nodata", options.nodata, "VALUE",
                 "Treat this value as nodata, whatever the file declares");
  command.flag_that(
      "--no-detect", [&options] { options.detect_nodata = false; },
      "Do not treat undeclared values of -32768, -9999 and 32767 as nodata");
  command.option_read_by(
      "--height-range",
      [&options](const std::string& text) { options.heights = parse_height_range(text); },
      "LOW,HIGH", "Heights in metres of black and of white in an image");
  command
      .option("--unknown-grey", options.unknown_grey, "GREY",
              "Grey level that means nodata in an image, from 0 (black) to 1 (white)")
      .within(0, 1);
  command.heading("Options");
}

void add_write_options(Command& command, WriteOptions& options) {
  command.heading("Writing");
  command.option("--format", options.format, "NAME",
                 "GDAL driver name, HGT or image (chosen by the extension of OUT)");
  command
      .option_read_by(
          "--type",
          [&options](const std::string& name) {
            const auto& names = cell_type_names();
            options.type = CellType(std::ranges::find(names, name) - names.begin());
          },
          "TYPE", "Type of the cells (that of IN, where there is one)")
      .one_of(cell_type_names());
  command.option("--out-nodata", options.nodata, "VALUE",
                 "Nodata value that the output declares (that of IN, or a usual one)");
  const auto add = [&options](const std::string& key, const std::string& value) {
    options.creation_options.emplace_back(key, value);
  };
  command
      .option_read_by(
          "--compress", [add](const std::string& name) { add("COMPRESS", upper(name)); }, "NAME",
          "Compression of GeoTIFF and COG")
      .one_of({"deflate", "lzw", "zstd", "none"})
      .show_default("deflate");
  command
      .option_read_by(
          "--co",
          [add](const std::string& text) {
            const auto [key, value] =
                parse_pair_of("--co", text, "KEY=VALUE, for example ZLEVEL=9");
            add(key, value);
          },
          "KEY=VALUE", "Creation option of the GDAL driver; may be repeated")
      .repeats = true;
  command.heading("Options");
}

void add_set_option(Command& command, std::vector<std::string>& set, const std::string& of) {
  command.option("-s,--set", set, "KEY=VALUE",
                 fmt::format("Setting of the {}; may be repeated", of));
}

std::pair<std::string, std::string> parse_setting(const std::string& text) {
  return parse_pair_of("--set", text, "KEY=VALUE, for example I=0.4");
}

std::string parse_crs(const std::string& option, const std::string& text) {
  try {
    crs_wkt(text);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(option + std::string(error.what()).substr(3));  // after "crs"
  }
  const bool number = text.find_first_not_of("0123456789") == text.npos;
  return number && !text.empty() ? "EPSG:" + text : text;
}

void add_crs_option(Command& command, const std::string& option, std::string& crs,
                    const std::string& doc) {
  command
      .option_read_by(
          option, [option, &crs](const std::string& text) { crs = parse_crs(option, text); }, "CRS",
          doc)
      .kind("crs");
}

double parse_number(std::string_view option, const std::string& text, std::string_view must_be) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    refuse(option, text, must_be);
  return value;
}

double parse_percent(std::string_view option, const std::string& text) {
  const auto must_be = "a percentage such as 3.4%, or a part such as 0.034 (above 0, up to 1)";
  const bool percent = text.ends_with('%');
  std::string number = text.substr(0, text.size() - percent);
  while (percent && number.ends_with(' ')) number.pop_back();
  const double value = parse_number(option, number, must_be) * (percent ? 1 : 100);
  if (value <= 0 || value > 100) refuse(option, text, must_be);
  return value;
}

double parse_share(std::string_view option, const std::string& text) {
  return parse_percent(option, text) / 100;
}

std::string option_of(std::string_view field) {
  std::string option = "--" + std::string(field);
  std::ranges::replace(option, '_', '-');
  return option;
}

std::string grouped(std::size_t n) {
  if (n < 1000) return fmt::format("{}", n);
  return fmt::format("{} {:03}", grouped(n / 1000), n % 1000);
}

std::string percent_of(std::size_t cells, std::size_t all) {
  return fmt::format("{:.3g} %", all == 0 ? 0.0 : 100.0 * double(cells) / double(all));
}

bool holds_metadata(const std::string& path, const std::string& format) {
  if (!format.empty()) return format != "HGT";
  if (path.ends_with('/')) return false;  // a folder of .hgt
  std::string name = fs::path(path).filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return !name.ends_with(".hgt") && !name.ends_with(".hgt.gz") && !name.ends_with(".hgt.zip");
}

void warn_of_outliers(const Dem& dem, Shell& shell) {
  const Outliers found = find_outliers(dem);
  if (found.count == 0) return;
  std::vector<std::string> names;
  for (const auto& o : found.first)
    names.push_back(fmt::format("{} m in cell {},{}", o.z, o.col, o.row));
  shell.say(
      "warning: {} known heights lie outside {:.0f} to {:.0f} m and bend the surface around them: "
      "{}{}; if they mean nodata, give --nodata VALUE",
      grouped(found.count), found.low_m, found.high_m, fmt::join(names, ", "),
      found.count > names.size() ? ", ..." : "");
}

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  std::error_code error;
  made_ = fs::create_directory(path, error);
  if (std::error_code e; fs::exists(path, e) && !fs::is_directory(path, e))
    throw IoError(path, "exists and is not a folder");
  if (error) throw IoError(path, error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code not_empty;
  if (made_) fs::remove(path_, not_empty);
}

std::string OutputFolder::file(std::string_view name) const {
  return (fs::path(path_) / name).string();
}

}  // namespace dem::app
