#include "dem/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {
namespace {

void check_size(const char* name, Size size, Size truth) {
  if (size != truth)
    throw std::invalid_argument(fmt::format("{} is {} x {} cells; must be {} x {}, as truth", name,
                                            size.cols, size.rows, truth.cols, truth.rows));
}

Mask known_in_both(const Dem& a, const Dem& b) {
  Mask both = a.known;
  for (std::size_t i = 0; i < both.cells().size(); ++i)
    both.cells()[i] = a.known.cells()[i] && b.known.cells()[i];
  return both;
}

/// Those of `cells` that `dem` does not know.
Mask without_known(Mask cells, const Dem& dem) {
  for (std::size_t i = 0; i < cells.cells().size(); ++i)
    if (dem.known.cells()[i]) cells.cells()[i] = 0;
  return cells;
}

}  // namespace

Calibration calibration(const Raster<float>& truth, const Raster<float>& got, const Mask& judged,
                        const Raster<float>& sigma) {
  Calibration all;
  double squares = 0;
  for (std::size_t i = 0; i < truth.cells().size(); ++i) {
    if (!judged.cells()[i] || !(sigma.cells()[i] > 0)) continue;
    const double ratio =
        std::abs(double(got.cells()[i]) - double(truth.cells()[i])) / double(sigma.cells()[i]);
    ++all.cells;
    all.within_1 += ratio <= 1;
    all.within_2 += ratio <= 2;
    all.within_3 += ratio <= 3;
    squares += ratio * ratio;
  }
  const auto n = double(std::max<std::size_t>(all.cells, 1));
  all.within_1 /= n, all.within_2 /= n, all.within_3 /= n;
  all.rms_ratio = std::sqrt(squares / n);
  return all;
}

Mask removed_cells(const Dem& whole, const Dem& sampled) {
  return without_known(whole.known, sampled);
}

Raster<float> completed(const Dem& dem, const Raster<float>& other) {
  Raster<float> z = dem.z;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    if (!dem.known.cells()[i]) z.cells()[i] = other.cells()[i];
  return z;
}

Evaluation evaluate_dem(const Dem& truth, const Dem& got, const EvaluationInputs& inputs,
                        const Run& run) {
  const Size size = truth.size();
  check_size("got", got.size(), size);
  if (inputs.sampled) check_size("sampled", inputs.sampled->size(), size);
  if (inputs.sigma) check_size("sigma", inputs.sigma->size(), size);

  Evaluation out;
  out.comparable = known_in_both(truth, got);
  const std::size_t compared = count(out.comparable);
  if (compared == 0) throw std::invalid_argument("got has no cell that is known in truth, too");
  out.judged = inputs.sampled ? without_known(out.comparable, *inputs.sampled) : out.comparable;
  if (count(out.judged) == 0)
    throw std::invalid_argument("sampled knows every cell; there is no filled cell to judge");
  out.unfilled = count(truth.known) - compared;

  const std::vector<Spacing> spacing = spacing_of_rows(truth);
  const Raster<float> truth_z = completed(truth, got.z), got_z = completed(got, truth.z);
  out.all = compare(truth_z, got_z, out.comparable, spacing, run.part(0, 0.4));
  if (inputs.sampled) out.filled = compare(truth_z, got_z, out.judged, spacing, run.part(0.4, 0.7));
  if (inputs.sigma) {
    out.calibration = calibration(truth_z, got_z, out.judged, *inputs.sigma);
    if (out.calibration->cells == 0)
      throw std::invalid_argument("sigma is above 0 in no cell that is judged");
  }

  // A spectrum needs whole surfaces, large enough to hold a few waves.
  if (compared == size.cells() && size.cols >= 16 && size.rows >= 16) {
    run.report(0.7, "spectrum");
    out.truth = power_spectrum(truth.z, truth.spacing);
    out.got = power_spectrum(got.z, truth.spacing);
  }
  return out;
}

}  // namespace dem
