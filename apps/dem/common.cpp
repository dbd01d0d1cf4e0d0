#include "common.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "dem/outliers.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

HeightRange parse_height_range(const std::string& text) {
  const auto must_be = "LOW,HIGH in metres with LOW < HIGH, e.g. 0,4800";
  const auto comma = text.find(',');
  HeightRange range{0, 0};
  if (comma != std::string::npos) {
    range.low_m = parse_number("height-range", text.substr(0, comma), must_be);
    range.high_m = parse_number("height-range", text.substr(comma + 1), must_be);
  }
  if (!(range.low_m < range.high_m))
    throw std::invalid_argument(fmt::format("height-range = {}; must be {}", text, must_be));
  return range;
}

}  // namespace

void Shell::add_options(CLI::App& app) {
  app.add_flag("--json", json, "print one JSON object on stdout")->group("Everywhere");
  app.add_flag("-q,--quiet", quiet, "no messages, no progress; errors only")->group("Everywhere");
  app.add_option("--progress", progress,
                 "bar, json (lines on stderr), none; auto: a bar on a terminal")
      ->check(one_of({"auto", "bar", "json", "none"}))
      ->type_name("HOW")
      ->capture_default_str()
      ->group("Everywhere");
  app.add_option("-j,--threads", threads, "0: as many as there are cores; the result is the same")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N")
      ->capture_default_str()
      ->group("Everywhere");
  app.add_flag("--overwrite", overwrite, "replace existing output")->group("Everywhere");
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

CLI::App* add_verb(CLI::App& app, Shell& shell, const std::string& name, const std::string& summary,
                   const std::string& examples, std::function<int()> work) {
  auto* verb = app.add_subcommand(name, summary);
  verb->footer("\nExamples:\n" + examples);
  verb->callback([&shell, work = std::move(work)] { shell.verb = work; });
  return verb;
}

void add_read_options(CLI::App& app, ReadOptions& options) {
  const char* group = "Reading";
  app.add_option("--band", options.band, "band to read, 1, 2, ...; needed when there are several")
      ->check(CLI::Range(1, 65535).description(""))
      ->type_name("N")
      ->group(group);
  app.add_option("--tile", options.tile, "name of an .hgt tile whose file name does not say it")
      ->type_name("N36E008")
      ->group(group);
  app.add_option_function<double>(
         "--nodata", [&options](double v) { options.nodata = v; },
         "this value means unknown, whatever the file declares")
      ->check(takes("number"))
      ->type_name("VALUE")
      ->group(group);
  app.add_flag_callback(
         "--no-detect", [&options] { options.detect_nodata = false; },
         "do not look for undeclared -32768, -9999, 32767")
      ->group(group);
  app.add_option_function<std::string>(
         "--height-range",
         [&options](const std::string& text) { options.heights = parse_height_range(text); },
         "metres of black and white of a heightmap image")
      ->type_name("LOW,HIGH")
      ->group(group);
  app.add_option_function<double>(
         "--unknown-grey", [&options](double v) { options.unknown_grey = v; },
         "grey of an image that means unknown, 0 black to 1 white")
      ->check(CLI::Range(0.0, 1.0).description(""))
      ->type_name("GREY")
      ->group(group);
}

namespace {

CLI::Validator mark(std::string name) {
  return {[](const std::string&) { return std::string(); }, "", std::move(name)};
}

}  // namespace

CLI::Validator takes(std::string_view kind) { return mark(fmt::format("{}{}", kTakesMark, kind)); }

CLI::Validator one_of(const std::vector<std::string>& names) {
  return CLI::IsMember(names).description("").name(
      fmt::format("{}{}", kChoicesMark, fmt::join(names, "|")));
}

CLI::Validator suggests(const std::vector<std::string>& names) {
  return mark(fmt::format("{}{}", kChoicesMark, fmt::join(names, "|")));
}

std::pair<std::string, std::string> parse_setting(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw std::invalid_argument("set = " + text + "; must be KEY=VALUE, e.g. I=0.4");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

double parse_number(std::string_view option, const std::string& text, std::string_view must_be) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", option, text, must_be));
  return value;
}

double parse_share(std::string_view option, const std::string& text) {
  const auto must_be = "a percentage above 0 % and up to 100 %, e.g. 3.4%";
  if (text.empty() || text.back() != '%')
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", option, text, must_be));
  const double percent = parse_number(option, text.substr(0, text.size() - 1), must_be);
  if (percent <= 0 || percent > 100)
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", option, text, must_be));
  return percent / 100;
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
      "{}{}; if they mean \"unknown\", --nodata VALUE says so",
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
