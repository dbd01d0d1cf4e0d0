#pragma once
// Erosion by running water and by falling rock [musgrave1989].

#include <functional>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// Options of erode. K_c, K_d, K_s, c_t are the paper's symbols; heights and water are metres.
struct ErosionOptions {
  int steps = 500;
  double rain_mm = 0;
  double rain_mm_per_km = 1000;
  int rain_every = 60;
  double K_c = 5;
  double K_d = 0.1;
  double K_s = 0.3;
  double talus_deg = 38;
  double c_t = 0.5;
  bool open_border = true;
};
std::vector<Field> fields(ErosionOptions& options);

/// The state after a step, for intermediate pictures: heights, and the water above them.
struct ErosionFrame {
  int step = 0;
  Raster<float> z;
  Raster<float> water_m;
};

/// Called after steps `every`, 2 `every`, ... from the calling thread.
struct ErosionFrames {
  int every = 0;  ///< 0: never
  std::function<void(const ErosionFrame&)> take = {};
};

struct Eroded {
  Raster<float> z;
  Raster<float> water_m;  ///< depth of the water at the end
  double before_m3 = 0;   ///< sum of height times cell area, in float64
  double after_m3 = 0;    ///< the same at the end, including settled sediment
  double carried_m3 = 0;  ///< sediment that left across the border: before = after + carried
};

/// Erodes a terrain. Rain falls, flows to all lower neighbours, takes soil along and deposits it.
/// Rock that is steeper than the talus angle slides.
/// Method: [musgrave1989] section 4. In each step a cell passes on the water f sum(d_k g_k). d_k >=
///         0 is its surface above that of neighbour k, and g_k = (shortest distance) / (distance of
///         k). f is at most 1 / (4 sum g_k), so that water levels out and does not oscillate. The
///         water may carry K_c times that amount. It lifts K_s of what is missing, and drops K_d of
///         what is too much. Soil slides to each neighbour by c_t / 16 of what the slope exceeds
///         the talus by. Departures: slopes, not differences. A step digs at most an eighth of the
///         mean drop, and fills at most the depth of the water and an eighth of the mean rise,
///         because otherwise towers would grow. The printed signs of the deposit at v and of c_t
///         are treated as misprints.
/// Rain:   rain_mm, and rain_mm_per_km for each kilometre above the lowest cell (the paper has a
///         thousandth of the height), every rain_every steps.
/// Needs:  known cells that are finite. Unknown cells are outside, behind a wall: nothing flows in
///         or out, and they do not change. A step has no length in years.
/// Gives:  heights on which the suspended sediment has settled where it was. With open_border,
///         water and sediment that reach the border leave, and water does not dig the border cells.
/// Cost:   O(cells * steps), 48 bytes a cell. Every cell gathers from the old state of its
///         neighbours, so any number of threads gives the same bits.
/// Throws: std::invalid_argument, Cancelled.
Eroded erode(const Dem& dem, const ErosionOptions& options = {}, const Run& run = {},
             const ErosionFrames& frames = {});

}  // namespace dem
