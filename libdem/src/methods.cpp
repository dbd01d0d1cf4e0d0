#include "dem/methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "dem/baseline.h"
#include "dem/faults.h"
#include "dem/contours.h"
#include "dem/generators.h"
#include "dem/mcmd.h"
#include "dem/networks.h"
#include "dem/noise.h"
#include "dem/riverland.h"
#include "dem/sketch.h"
#include "dem/spline.h"

namespace dem {

std::vector<FieldInfo> describe(const std::vector<Field>& fields) {
  std::vector<FieldInfo> infos;
  for (const auto& f : fields)
    infos.push_back({f.name(), f.type(), f.unit(), f.range(), f.text(), f.doc(), f.choices()});
  return infos;
}

/// A generator of whole planets.
Generator on_globe(Generator generator) {
  generator.globe = true;
  return generator;
}

const std::vector<Generator>& generators() {
  static const std::vector<Generator> table{
      make_generator<NoiseOptions>(
          "noise", "sums of noise, with roughness that may change from place to place",
          "musgrave1989",
          {{"foothills",
            "rough where high, smooth where low (plates 3 and 11)",
            {{"law", "heterogeneous"}, {"c_t", "0.4"}, {"relief_m", "900"}}},
           {"range",
            "the same along a winding ridge (plate 4)",
            {{"law", "heterogeneous"},
             {"shape", "ridge"},
             {"bend", "0.15"},
             {"c_t", "0.5"},
             {"relief_m", "1200"}}},
           {"canyon",
            "always positive noise weighted by the distance from a winding valley (plates 2, 9)",
            {{"shape", "valley"},
             {"bend", "0.15"},
             {"c_t", "0.8"},
             {"tilt", "0.3"},
             {"wavelength_m", "5000"},
             {"relief_m", "1500"}}},
           {"dimension",
            "fractal dimension 2 in the west to 3 in the east (plate 6)",
            {{"H", "1"}, {"H_law", "linear"}, {"H_east", "0"}, {"relief_m", "400"}}},
           {"filling",
            "a plane in the west, noise that fills space in the east (plate 5)",
            {{"H_law", "filling"}, {"octaves", "8"}, {"relief_m", "100"}}},
           {"warped",
            "places displaced by noise: local lacunarity (plates 1b, 7)",
            {{"warp", "0.3"}}},
           {"hybrid",
            "multifractal: rougher on heights, by the product of the longer waves",
            {{"law", "hybrid"}, {"H", "0.4"}, {"c_t", "0.7"}, {"relief_m", "800"}}},
           {"ridged",
            "multifractal of sharp crests",
            {{"law", "ridged"}, {"H", "0.9"}, {"c_t", "1"}, {"relief_m", "900"}}}},
          generate_noise),
      make_generator<FaultOptions>(
          "faults", "random straight faults, one side up, the other down", "faulting1996",
          {{"cliffs", "sides that part at once", {{"width_m", "0"}}}}, generate_faults),
      on_globe(make_generator<GlobeOptions>(
          "globe", "a planet cut along random great circles, in EPSG:4326", "faulting1996",
          {{"small-circles",
            "planes off the centre: no deep mirrors a mountain",
            {{"off_centre", "0.9"}}}},
          generate_globe)),
      make_generator<CollageOptions>(
          "collage", "humps and hollows pasted over each other", "faulting1996",
          {{"discs", "flat discs", {{"shape", "disc"}, {"step_m", "120"}, {"count", "20000"}}},
           {"rectangles",
            "rectangles along the axes",
            {{"shape", "rectangle"}, {"step_m", "120"}, {"count", "20000"}}},
           {"cones", "cones", {{"shape", "cone"}}},
           {"craters",
            "smooth pits H F / (F + x^2 + y^2), many small and few large",
            {{"shape", "crater"},
             {"count", "1500"},
             {"sign", "down"},
             {"size_exponent", "2.5"},
             {"radius_min_m", "150"},
             {"radius_max_m", "2500"}}}},
          generate_collage),
      make_generator<RidgesOptions>(
          "ridges", "ridges and rivers that grow by chance, and terrain around them", "belhadj2005",
          {{"mdi", "filled as there: MDI, then MD", {{"fill", "mdi"}}},
           {"figure11",
            "the bends and noise of [belhadj2007] figure 11 (a)",
            {{"I", "1"},
             {"I_bu", "6"},
             {"I_ridge", "1"},
             {"I_bu_ridge", "6"},
             {"H", "0.49"},
             {"rs", "0.5"}}}},
          generate_ridges),
      make_image_generator<DrawnSkeletonOptions>(
          "skeleton", "terrain around drawn ridges and rivers", "belhadj2005",
          "white: nothing; lighter greys: ridges; darker greys: rivers", {}, generate_skeleton),
      make_generator<GrownLandOptions>(
          "riverland", "rivers that grow into an island, and terrain that drains into them",
          "teoh2009",
          {{"cliffs", "plains by rivers and coasts, then cliffs", {{"profile", "cliffs"}}},
           {"terraces", "slopes in steps", {{"profile", "terraces"}}}},
          generate_riverland),
      make_image_generator<RiverLandOptions>(
          "painted_land", "rivers that grow into painted land, and terrain that drains into them",
          "teoh2009", "black: sea; white: land; grey: land with rocky outcrops", {},
          generate_painted_land),
      make_image_generator<SketchOptions>(
          "sketch", "a drawing of heights, filled by MCMD", "belhadj2007",
          "white: unknown; greys: heights from black to white",
          {{"bumped",
            "figure 12 (a)",
            {{"I", "-1.1"}, {"I_bu", "-20"}, {"H", "0.45"}, {"rt", "-0.2"}, {"rs", "1"}}},
           {"ridged", "figure 12 (b)", {{"I", "1.1"}, {"I_bu", "4"}, {"H", "0.45"}, {"rs", "1.1"}}},
           {"wall",
            "figure 13, a rough coat of paint; to be smoothed by two median filters",
            {{"salt", "0.01"},
             {"I", "3"},
             {"I_bu", "7.5"},
             {"H", "0.5"},
             {"rt", "0.1"},
             {"rs", "1.3"}}}},
          generate_sketch),
      make_generator<LSystemOptions>("lsystem", "MCMD around the path of an L-system",
                                     "belhadj2007", {}, generate_lsystem),
  };
  return table;
}

const std::vector<FillMethod>& fill_methods() {
  static const std::vector<FillMethod> table{
      make_method<McmdOptions>(
          "mcmd", "Morphologically Constrained Midpoint Displacement: bottom-up, then top-down",
          "belhadj2007",
          {{"paper",
            "as published: triangle-edge, waves, plain means",
            {{"subdivision", "triangle_edge"}, {"order", "waves"}, {"weight_exponent", "0"}}}},
          [](const Dem& d, const McmdOptions& o, const Run& r) { return fill_mcmd(d, o, r); }),
      make_method<SplineOptions>(
          "spline",
          "terrain spline: springs of three orders that bend with the ground; most accurate",
          "szeliski1989",
          {{"plain", "springs that do not bend: faster", {{"adaptive", "false"}}},
           {"plate",
            "the classical thin plate",
            {{"parameters", "manual"},
             {"L1", "0"},
             {"L3", "0"},
             {"fourth_order", "false"},
             {"adaptive", "false"}}}},
          [](const Dem& d, const SplineOptions& o, const Run& r) { return fill_spline(d, o, r); }),
      make_method<ContourOptions>(
          "contours",
          "the spline held between contour lines: no terraces, hills beyond the last line", "", {},
          [](const Dem& d, const ContourOptions& o, const Run& r) {
            return fill_contours(d, o, r);
          }),
      make_method<MdiOptions>("mdi",
                              "Midpoint Displacement's Inverse with its noise, then plain MD",
                              "belhadj2005", {}, fill_mdi),
      make_method<MdOptions>(
          "md", "plain midpoint displacement from the corners down; spikes at sparse data",
          "belhadj2007", {},
          [](const Dem& d, const MdOptions& o, const Run& r) { return fill_md(d, o, r); }),
      make_method<NearestOptions>("nearest", "the elevation of the nearest known cell",
                                  "felzenszwalb2012", {}, fill_nearest),
  };
  return table;
}

/// The row called `name`, "NAME" or "NAME:PRESET", and the settings of its preset.
template <class Row>
std::pair<const Row*, Settings> find_row(const std::vector<Row>& table, std::string_view kind,
                                         std::string_view name) {
  const auto colon = name.find(':');
  const auto row = std::ranges::find(table, name.substr(0, colon), &Row::name);
  std::vector<std::string> names;
  if (row == table.end()) {
    for (const auto& r : table) names.push_back(r.name);
    throw std::invalid_argument(
        fmt::format("unknown {} \"{}\"; must be one of {}", kind, name, fmt::join(names, ", ")));
  }
  if (colon == std::string_view::npos) return {&*row, {}};
  const auto preset = std::ranges::find(row->presets, name.substr(colon + 1), &Preset::name);
  if (preset == row->presets.end()) {
    for (const auto& p : row->presets) names.push_back(row->name + ":" + p.name);
    throw std::invalid_argument(
        fmt::format("unknown preset \"{}\"; {} has {}", name, row->name,
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  return {&*row, preset->settings};
}

ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name) {
  const auto [method, settings] = find_row(table, "method", name);
  return {method, settings};
}

ChosenGenerator find_generator(std::string_view name) {
  const auto [generator, settings] = find_row(generators(), "generator", name);
  return {generator, settings};
}

std::string_view default_fill_method() { return "spline"; }

}  // namespace dem
