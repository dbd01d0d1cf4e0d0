#pragma once
// The table of fill methods: names -> functions. The one door for command line, bindings, tests
// and benchmarks. A new method is one row here.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// What a field of a method looks like from outside.
struct FieldInfo {
  std::string name, type, unit, range, default_text, doc;
  std::vector<std::string> choices;
};

/// A named group of settings, chosen as `method:preset`.
struct Preset {
  std::string name, doc;
  Settings settings;
};

/// What sets a method apart from most.
struct MethodTraits {
  bool for_contours = false;        ///< its known cells must be contour lines
  bool honours_breaklines = false;  ///< it lets the surface jump where Dem::breaks says so
};

struct FillMethod {
  std::string name;
  std::string summary;   ///< one line
  std::string citation;  ///< key in REFERENCES.md, "" when the method is folklore
  std::vector<FieldInfo> fields;
  std::vector<Preset> presets;

  /// Fills every unknown cell; known cells come back bit for bit.
  /// Throws std::invalid_argument for bad settings or when no cell is known, Cancelled.
  std::function<Filled(const Dem&, const Settings&, const Run&)> fill;
  MethodTraits traits{};
};

/// How FieldInfo is read off a list of fields.
std::vector<FieldInfo> describe(const std::vector<Field>& fields);

/// A row of the table from an Options struct with `fields(Options&)` and a function
/// `Filled or Raster<float> (const Dem&, const Options&, const Run&)`.
template <class Options, class Fill>
FillMethod make_method(std::string name, std::string summary, std::string citation,
                       std::vector<Preset> presets, Fill fill, MethodTraits traits = {}) {
  Options defaults;
  return {std::move(name),
          std::move(summary),
          std::move(citation),
          describe(fields(defaults)),
          std::move(presets),
          [fill](const Dem& dem, const Settings& settings, const Run& run) -> Filled {
            Options options;
            apply(settings, fields(options));
            return Filled{fill(dem, options, run)};
          },
          traits};
}

/// The methods of this library. dem/baselines.h (target dem::io) has those of GDAL and OpenImageIO.
const std::vector<FillMethod>& fill_methods();

/// The method that fills when none is named.
std::string_view default_fill_method();

/// A method with its preset's settings put before the caller's.
struct ChosenMethod {
  const FillMethod* method = nullptr;
  Settings settings;
};

/// Finds "mcmd" or "mcmd:paper" in the table.
/// Throws std::invalid_argument that lists the names there are.
ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name);

}  // namespace dem
