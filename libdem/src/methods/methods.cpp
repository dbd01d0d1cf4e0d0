#include "dem/methods.h"

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
          [](const Dem& d, const SplineOptions& o, const Run& r) { return fill_spline(d, o, r); },
          {.honours_breaklines = true}),
      make_method<ContourOptions>(
          "contours",
          "the spline held between contour lines: no terraces, hills beyond the last line", "", {},
          [](const Dem& d, const ContourOptions& o, const Run& r) {
            return fill_contours(d, o, r);
          },
          {.for_contours = true, .honours_breaklines = true}),
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

ChosenMethod find_method(const std::vector<FillMethod>& table, std::string_view name) {
  const auto [method, settings] = find_row(table, "method", name);
  return {method, settings};
}

std::string_view default_fill_method() { return "spline"; }

}  // namespace dem
