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

/// The memory that a method needs to fill a window, the window's heights included. It has no
/// default: a row of the table that does not state it does not compile.
struct BytesPerCell {
  constexpr BytesPerCell(std::size_t n) : value(n) {}
  std::size_t value;
};

/// What every row of the table states of its method.
struct MethodTraits {
  BytesPerCell bytes_per_cell;
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

  /// Throws std::invalid_argument for settings that `fill` would refuse. Fills nothing.
  std::function<void(const Settings&)> check;

  /// Whether `fill` gives a standard error with these settings; throws as `check` does.
  std::function<bool(const Settings&)> gives_sigma;

  MethodTraits traits;

  /// Fills, when each known cell has a standard error of its own, in metres; known cells come back
  /// smoothed. Empty when the method has no use for such errors.
  std::function<Filled(const Dem&, const Raster<float>& sigma_m, const Settings&, const Run&)>
      fill_noisy{};

  /// Fills between contour lines whose cells have two heights: the level of their line, in the DEM,
  /// and that of their centre. Empty unless the method is for contour lines.
  std::function<Filled(const Dem&, const Raster<float>& at_centres, const Settings&, const Run&)>
      fill_lines{};

  bool has_setting(std::string_view setting) const;
};

/// How FieldInfo is read off a list of fields.
std::vector<FieldInfo> describe(const std::vector<Field>& fields);

/// Options that are set as asked for, and checked: by `check_settings(const Options&)` where there
/// is one, else field by field.
template <class Options>
Options checked_options(const Settings& settings) {
  Options options;
  apply(settings, fields(options));
  if constexpr (requires { check_settings(options); })
    check_settings(options);
  else
    check(fields(options));
  return options;
}

/// A row of the table from an Options struct with `fields(Options&)` and a function
/// `Filled or Raster<float> (const Dem&, const Options&, const Run&)`. The method gives a standard
/// error when `gives_sigma(const Options&)` is there and says so.
template <class Options, class Fill>
FillMethod make_method(std::string name, std::string summary, std::string citation,
                       MethodTraits traits, std::vector<Preset> presets, Fill fill) {
  Options defaults;
  return {std::move(name),
          std::move(summary),
          std::move(citation),
          describe(fields(defaults)),
          std::move(presets),
          [fill](const Dem& dem, const Settings& settings, const Run& run) -> Filled {
            return Filled{fill(dem, checked_options<Options>(settings), run)};
          },
          [](const Settings& settings) { checked_options<Options>(settings); },
          [](const Settings& settings) {
            const auto options = checked_options<Options>(settings);
            if constexpr (requires { gives_sigma(options); })
              return gives_sigma(options);
            else
              return false;
          },
          traits};
}

/// The methods of this library. dem/baselines.h (target dem::io) has those of GDAL and OpenImageIO.
const std::vector<FillMethod>& fill_methods();

/// The method that fills when none is named.
std::string_view default_fill_method();

/// The method that fills between contour lines when none is named.
std::string_view default_contour_method();

/// A method with its preset's settings put before the caller's.
struct ChosenMethod {
  const FillMethod* method = nullptr;
  Settings settings;

  void check() const { method->check(settings); }  ///< throws as FillMethod::check
  bool gives_sigma() const { return method->gives_sigma(settings); }
};

/// Finds "mcmd" or "mcmd:paper" in the table.
/// Throws std::invalid_argument that lists the names there are.
ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name);

}  // namespace dem
