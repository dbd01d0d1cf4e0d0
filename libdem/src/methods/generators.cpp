#include "dem/generators.h"

#include "dem/faults.h"
#include "dem/networks.h"
#include "dem/noise.h"
#include "dem/riverland.h"
#include "dem/sketch.h"
#include "methods/find_row.h"

namespace dem {
using namespace methods;
namespace {

/// A generator of whole planets.
Generator on_globe(Generator generator) {
  generator.globe = true;
  return generator;
}

}  // namespace

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
          "teoh2009",
          "black: sea; white: land; grey: land with rocky outcrops; of a vector layer also ridges",
          {}, generate_painted_land),
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

ChosenGenerator find_generator(std::string_view name) {
  const auto [generator, settings] = find_row(generators(), "generator", name);
  return {generator, settings};
}

}  // namespace dem
