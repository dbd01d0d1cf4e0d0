#include "dem/methods.h"

#include <algorithm>

#include "dem/baseline.h"
#include "dem/contours.h"
#include "dem/mcmd.h"
#include "dem/spline.h"
#include "methods/find_row.h"

namespace dem {
using namespace methods;

std::vector<FieldInfo> describe(const std::vector<Field>& fields) {
  std::vector<FieldInfo> infos;
  for (const auto& f : fields)
    infos.push_back({f.name(), f.type(), f.unit(), f.range(), f.text(), f.doc(), f.choices()});
  return infos;
}

bool FillMethod::has_setting(std::string_view setting) const {
  return std::ranges::find(fields, setting, &FieldInfo::name) != fields.end();
}

namespace {

/// The spline with each cell's own noise. Its springs' scale comes from a first solve.
Filled fill_spline_noisy(const Dem& dem, const Raster<float>& sigma_m, const Settings& settings,
                         const Run& run) {
  auto options = checked_options<SplineOptions>(settings);
  SplineOptions first = options;
  first.sigma = SplineSigma::law;
  const double scale = fill_spline(dem, first, run.part(0, 0.5)).scale_m;
  if (!(scale > 0))
    return fill_spline(dem, options, run.part(0.5, 1));  // a plane: nothing to weigh
  Raster<float> noise(dem.size());
  for (std::size_t i = 0; i < noise.cells().size(); ++i) {
    const double sigma = double(sigma_m.cells()[i]);
    noise.cells()[i] = float(sigma * sigma / (scale * scale));
  }
  options.nugget = 1;
  options.smooth_known = true;
  return fill_spline(dem, noise, options, run.part(0.5, 1));
}

Filled fill_between_lines(const Dem& lines, const Raster<float>& at_centres,
                          const Settings& settings, const Run& run) {
  return fill_contours(lines, at_centres, checked_options<ContourOptions>(settings), run);
}

FillMethod spline_method() {
  FillMethod method = make_method<SplineOptions>(
      "spline", "terrain spline: springs of three orders that bend with the ground; most accurate",
      "szeliski1989", {.bytes_per_cell = 110, .honours_breaklines = true},
      {{"plain", "springs that do not bend: faster", {{"adaptive", "false"}}},
       {"plate",
        "the classical thin plate",
        {{"parameters", "manual"},
         {"L1", "0"},
         {"L3", "0"},
         {"fourth_order", "false"},
         {"adaptive", "false"}}}},
      [](const Dem& d, const SplineOptions& o, const Run& r) { return fill_spline(d, o, r); });
  method.fill_noisy = fill_spline_noisy;
  return method;
}

FillMethod contour_method() {
  FillMethod method = make_method<ContourOptions>(
      "contours", "the spline held between contour lines: no terraces, hills beyond the last line",
      "", {.bytes_per_cell = 64, .for_contours = true, .honours_breaklines = true}, {},
      [](const Dem& d, const ContourOptions& o, const Run& r) { return fill_contours(d, o, r); });
  method.fill_lines = fill_between_lines;
  return method;
}

}  // namespace

const std::vector<FillMethod>& fill_methods() {
  static const std::vector<FillMethod> table{
      make_method<McmdOptions>(
          "mcmd", "Morphologically Constrained Midpoint Displacement: bottom-up, then top-down",
          "belhadj2007", {.bytes_per_cell = 24},
          {{"paper",
            "as published: triangle-edge, waves, plain means",
            {{"subdivision", "triangle_edge"}, {"order", "waves"}, {"weight_exponent", "0"}}}},
          [](const Dem& d, const McmdOptions& o, const Run& r) { return fill_mcmd(d, o, r); }),
      spline_method(),
      contour_method(),
      make_method<MdiOptions>("mdi",
                              "Midpoint Displacement's Inverse with its noise, then plain MD",
                              "belhadj2005", {.bytes_per_cell = 24}, {}, fill_mdi),
      make_method<MdOptions>(
          "md", "plain midpoint displacement from the corners down; spikes at sparse data",
          "belhadj2007", {.bytes_per_cell = 24}, {},
          [](const Dem& d, const MdOptions& o, const Run& r) { return fill_md(d, o, r); }),
      make_method<NearestOptions>("nearest", "the elevation of the nearest known cell",
                                  "felzenszwalb2012", {.bytes_per_cell = 64}, {}, fill_nearest),
  };
  return table;
}

ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name) {
  const auto [method, settings] = find_row(table, "method", name);
  return {method, settings};
}

std::string_view default_fill_method() { return "spline"; }
std::string_view default_contour_method() { return "contours"; }

}  // namespace dem
