#pragma once
// The table of terrain generators: names and functions. dem/methods.h has that of fill methods.

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "dem/canvas.h"
#include "dem/dem.h"
#include "dem/methods.h"

namespace dem {

struct Generator {
  std::string name;
  std::string summary;   ///< one line
  std::string citation;  ///< key in REFERENCES.md
  std::vector<FieldInfo> fields;
  std::vector<Preset> presets;
  std::string image;   ///< what its input image shows; "" when it takes none
  bool globe = false;  ///< whether the canvas is a grid of degrees on the whole Earth

  /// Makes a terrain whose cells are all known. The drawing is empty when the generator takes none.
  /// Throws std::invalid_argument for bad settings, sizes or drawings; Cancelled.
  std::function<Dem(const Canvas&, const Drawing&, const Settings&, const Run&)> generate;
};

/// A row of the table from an Options struct with `fields(Options&)` and a function
/// `Raster<float>(const Canvas&, const Options&, const Run&)`.
template <class Options, class Generate>
Generator make_generator(std::string name, std::string summary, std::string citation,
                         std::vector<Preset> presets, Generate generate) {
  Options defaults;
  return {
      std::move(name),
      std::move(summary),
      std::move(citation),
      describe(fields(defaults)),
      std::move(presets),
      "",
      false,
      [generate](const Canvas& canvas, const Drawing&, const Settings& settings, const Run& run) {
        Options options;
        apply(settings, fields(options));
        return on_canvas(canvas, generate(canvas, options, run));
      }};
}

/// The same for a function that starts from a drawing:
/// `Raster<float>(const Canvas&, const Drawing& or its grey levels, const Options&, const Run&)`.
template <class Options, class Generate>
Generator make_image_generator(std::string name, std::string summary, std::string citation,
                               std::string image, std::vector<Preset> presets, Generate generate) {
  Options defaults;
  return {std::move(name),
          std::move(summary),
          std::move(citation),
          describe(fields(defaults)),
          std::move(presets),
          std::move(image),
          false,
          [generate](const Canvas& canvas, const Drawing& drawing, const Settings& settings,
                     const Run& run) {
            Options options;
            apply(settings, fields(options));
            if constexpr (std::is_invocable_v<Generate, const Canvas&, const Drawing&,
                                              const Options&, const Run&>)
              return on_canvas(canvas, generate(canvas, drawing, options, run));
            else
              return on_canvas(canvas, generate(canvas, drawing.grey, options, run));
          }};
}

const std::vector<Generator>& generators();

/// A generator with its settings: those of the preset come before those of the caller.
struct ChosenGenerator {
  const Generator* generator = nullptr;
  Settings settings;
};

/// Finds "noise" or "noise:ridged". Throws std::invalid_argument that lists the existing names.
ChosenGenerator find_generator(std::string_view name);

}  // namespace dem
