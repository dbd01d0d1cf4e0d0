#pragma once
// What every verb shares: options, progress, messages, exit codes, numbers written as text.

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "dem/dem.h"
#include "dem/evaluation.h"
#include "dem/io/rasters.h"
#include "dem/run.h"
#include "progress.h"

namespace dem::app {

using Json = nlohmann::ordered_json;

enum Exit { kDone = 0, kUsage = 1, kFile = 2, kUnfilled = 3, kCheckFailed = 4, kInterrupted = 5 };

/// The options that every verb takes, and what they govern.
class Shell {
 public:
  bool json = false, quiet = false, overwrite = false;
  int threads = 0;
  std::string progress = "auto";
  std::string command;  ///< the command line as it was given

  /// Adds the shared options to a verb.
  void add_options(Command& command);

  /// Threads and progress as asked for; a stop signal cancels whatever runs with it.
  Run run();

  /// A message for a person, on stderr; silent with --quiet.
  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) {
    if (!quiet) message(fmt::format(format, std::forward<Args>(args)...));
  }

  void clear_bar() { bar_.clear(); }

  /// Results, on stdout: `text` for a person, or the object with --json.
  void print(const Json& object, std::string_view text);

 private:
  void message(const std::string& line);

  Progress bar_;
};

/// Options of verbs that read a DEM: --band, --tile, --nodata, --no-detect, --height-range ...
void add_read_options(Command& command, ReadOptions& options);

/// Options of verbs that write a raster: --format, --type, --out-nodata, --compress, --co.
void add_write_options(Command& command, WriteOptions& options);

/// --set KEY=VALUE; `of`: what has the settings.
void add_set_option(Command& command, std::vector<std::string>& set, const std::string& of);

/// "mcmd", "mcmd:paper", ... of a table of methods or generators.
template <class Row>
std::vector<std::string> names_and_presets(const std::vector<Row>& table) {
  std::vector<std::string> names;
  for (const auto& row : table) {
    names.push_back(row.name);
    for (const auto& preset : row.presets) names.push_back(row.name + ":" + preset.name);
  }
  return names;
}

/// "key=value"; throws std::invalid_argument.
std::pair<std::string, std::string> parse_setting(const std::string& text);

/// A part of a whole, in (0, 1]: "3.4%", "3.4 %" and "0.034" are one. Throws std::invalid_argument
/// that names the option.
double parse_share(std::string_view option, const std::string& text);

/// The same in percent, in (0, 100].
double parse_percent(std::string_view option, const std::string& text);

/// "EPSG:32611", "32611", WKT or PROJ's words, as the library takes them. Throws
/// std::invalid_argument that names the option.
std::string parse_crs(const std::string& option, const std::string& text);

/// An option that takes a coordinate system.
void add_crs_option(Command& command, const std::string& option, std::string& crs,
                    const std::string& doc);

/// Throws std::invalid_argument `option = text; must be ...`.
double parse_number(std::string_view option, const std::string& text, std::string_view must_be);

/// The option of the command line that sets a field of the library: "max_area_km2" ->
/// "--max-area-km2".
std::string option_of(std::string_view field);

/// 1050625 -> "1 050 625".
std::string grouped(std::size_t n);

/// `cells` of `all`, in percent.
std::string percent_of(std::size_t cells, std::size_t all);

/// Whether a file written so can say how it was made: an .hgt cannot.
bool holds_metadata(const std::string& path, const std::string& format);

/// Warns of known heights that cannot be meant, by name.
void warn_of_outliers(const Dem& dem, Shell& shell);

/// A folder for results. Made if it is not there; taken away again if nothing was written in it.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  std::string file(std::string_view name) const;

 private:
  std::string path_;
  bool made_ = false;
};

}  // namespace dem::app
