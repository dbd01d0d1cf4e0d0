#include "dem/mcmd.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "midpoint/contour_sides.h"
#include "midpoint/midpoint.h"
#include "midpoint/row_kernels.h"

namespace dem {
using namespace midpoint;
namespace {

const std::vector<std::string> subdivisions{"triangle_edge", "diamond_square"};
const Range bend_range{-100, 100};

/// The lowest known elevation, 0 when there is none.
float lowest_known(const Dem& dem) {
  float lowest = std::numeric_limits<float>::infinity();
  for (int row = 0; row < dem.z.rows(); ++row)
    lowest = std::min(
        lowest, lowest_of_known(dem.z.row(row).data(), dem.known.row(row).data(), dem.z.cols()));
  return lowest == std::numeric_limits<float>::infinity() ? 0 : lowest;
}

/// What the passes share; the heights' zero is the datum where bends act on it, else near the data.
Midpoint midpoint_of(const Dem& dem, const Raster<CellKind>& kinds, Subdivision subdivision,
                     double datum_m, bool bends, const Run& run) {
  const double reference_m = bends ? datum_m : double(lowest_known(dem));
  return {dem, kinds, subdivision, float(reference_m), run};
}

void check_kinds(const Dem& dem, const Raster<CellKind>& kinds) {
  if (!kinds.empty() && kinds.size() != dem.size())
    throw std::invalid_argument(fmt::format("kinds is {} x {}; must be {} x {} as dem, or empty",
                                            kinds.cols(), kinds.rows(), dem.z.cols(),
                                            dem.z.rows()));
}

/// Fields that all three methods of this header share.
template <class Options>
Field subdivision_field(Options& o) {
  return {
      "subdivision", o.subdivision, subdivisions,
      "an edge's midpoint is the mean of its two ends, or of its ends and both squares' centres"};
}

template <class Options>
void add_noise_fields(std::vector<Field>& list, Options& o) {
  list.emplace_back("datum_m", o.datum_m, Range{-20000, 20000}, "m",
                    "elevation that the bends act from, and that unknown corners start at");
  list.emplace_back("H", o.H, Range{-0.5, 1}, "",
                    "equation 1: noise falls as 2^-(1 + 2 H) from one level to the next finer");
  list.emplace_back("rt", o.rt, Range{-10, 10}, "",
                    "equation 1: shift of the random numbers [-1, 1]");
  list.emplace_back("rs", o.rs, Range{0, 1e6}, "m/cell",
                    "equation 1: noise at the coarsest level, per cell of distance; 0: none");
  list.emplace_back("seed", o.seed, "of the noise");
}

Field bend_field(const char* name, double& value, const char* doc) {
  return {name, value, bend_range, "", doc};
}

template <class Options>
Noise noise(const Options& o) {
  return {o.H, o.rt, o.rs, o.seed};
}

Bend bend(const McmdOptions& o) { return {o.I, o.I_ridge, o.I_river}; }
Pull pull(const McmdOptions& o) {
  return {{o.I_bu, o.I_bu_ridge, o.I_bu_river}, o.weight_exponent};
}
McmdOptions one_sided(McmdOptions o) {
  o.two_sided = false;
  return o;
}
bool bends(const McmdOptions& o) { return bend(o) != Bend{} || pull(o).bend != Bend{}; }

}  // namespace

std::vector<Field> fields(McmdOptions& o) {
  std::vector<Field> list{
      subdivision_field(o),
      {"order",
       o.order,
       {"waves", "levels"},
       "how known elevations rise: in the waves of algorithm 1, or each level once it is complete"},
      {"weight_exponent",
       o.weight_exponent,
       {0, 16},
       "",
       "a child at distance d weighs d^-weight_exponent in its ascendant; 0: the paper's plain "
       "mean"},
      bend_field(
          "I", o.I,
          "equation 2, top-down: elevations fall (> 0) or rise (< 0) with distance; 0: plain mean"),
      bend_field("I_bu", o.I_bu, "equation 3, the same in the bottom-up pass"),
      bend_field("I_ridge", o.I_ridge, "I where the ascendant is a ridge cell"),
      bend_field("I_bu_ridge", o.I_bu_ridge, "I_bu where the child is a ridge cell"),
      bend_field("I_river", o.I_river, "I where the ascendant is a river cell"),
      bend_field("I_bu_river", o.I_bu_river, "I_bu where the child is a river cell"),
  };
  add_noise_fields(list, o);
  list.emplace_back("two_sided", o.two_sided,
                    "known cells are contour lines: up and down from each, the slope to the next");
  return list;
}

std::vector<Field> fields(MdOptions& o) {
  std::vector<Field> list{
      subdivision_field(o),
      bend_field("I", o.I,
                 "equation 2: elevations fall (> 0) or rise (< 0) with distance; 0: plain mean"),
      bend_field("I_ridge", o.I_ridge, "I where the ascendant is a ridge cell"),
      bend_field("I_river", o.I_river, "I where the ascendant is a river cell"),
  };
  add_noise_fields(list, o);
  return list;
}

std::vector<Field> fields(MdiOptions& o) {
  std::vector<Field> list{
      subdivision_field(o),
      {"rs_bu",
       o.rs_bu,
       {0, 1e6},
       "m/cell",
       "noise of the bottom-up means, per cell of the children's mean distance; the paper's is 1"},
  };
  add_noise_fields(list, o);
  return list;
}

Raster<float> fill_mcmd(const Dem& dem, const McmdOptions& o, const Run& run,
                        const Raster<CellKind>& kinds) {
  if (o.two_sided) {
    check_fillable(dem);
    return fill_mcmd(with_contour_sides(dem, run.part(0, 0.8)), one_sided(o), run.part(0.8, 1),
                     kinds);
  }
  if (o.order == UpOrder::waves) {
    const Dem carried = carry_up_mcmd(dem, o, run.part(0, 0.7), kinds);
    const auto fill =
        midpoint_of(carried, kinds, o.subdivision, o.datum_m, bends(o), run.part(0.7, 1));
    return displace(fill, bend(o), noise(o));
  }
  check_options(o);
  check_fillable(dem);
  check_kinds(dem, kinds);
  const auto fill = midpoint_of(dem, kinds, o.subdivision, o.datum_m, bends(o), run);
  return carry_up_and_displace(fill, pull(o), bend(o), noise(o));
}

Dem carry_up_mcmd(const Dem& dem, const McmdOptions& o, const Run& run,
                  const Raster<CellKind>& kinds) {
  check_options(o);
  check_fillable(dem);
  check_kinds(dem, kinds);
  if (o.two_sided)
    return carry_up_mcmd(with_contour_sides(dem, run.part(0, 0.8)), one_sided(o), run.part(0.8, 1),
                         kinds);
  const auto fill = midpoint_of(dem, kinds, o.subdivision, o.datum_m, bends(o), run);
  return o.order == UpOrder::levels ? carry_up_by_levels(fill, pull(o))
                                    : carry_up_in_waves(fill, pull(o), {});
}

Raster<float> fill_md(const Dem& dem, const MdOptions& o, const Run& run,
                      const Raster<CellKind>& kinds) {
  check_options(o);
  check_shape(dem);
  check_kinds(dem, kinds);
  const Bend bend{o.I, o.I_ridge, o.I_river};
  const auto fill = midpoint_of(dem, kinds, o.subdivision, o.datum_m, bend != Bend{}, run);
  return displace(fill, bend, noise(o), o.datum_m);
}

Raster<float> fill_mdi(const Dem& dem, const MdiOptions& o, const Run& run) {
  const Dem carried = carry_up_mdi(dem, o, run.part(0, 0.7));
  const Raster<CellKind> no_kinds;
  const auto fill =
      midpoint_of(carried, no_kinds, o.subdivision, o.datum_m, false, run.part(0.7, 1));
  return displace(fill, {}, noise(o));
}

Dem carry_up_mdi(const Dem& dem, const MdiOptions& o, const Run& run) {
  check_options(o);
  check_fillable(dem);
  const Raster<CellKind> no_kinds;
  return carry_up_in_waves(midpoint_of(dem, no_kinds, o.subdivision, o.datum_m, false, run), {},
                           {o.rs_bu, o.seed});
}

}  // namespace dem
