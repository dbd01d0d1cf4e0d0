#include "scores.h"

#include <cmath>

#include "dem/io/geodesy.h"

namespace dem::app {
namespace {

Json as_json(const Errors& e) {
  Json json{{"cells", e.cells}};
  for (const auto& m : kMeasures) json[std::string(m.name) + "_" + m.unit] = e.*m.value;
  return json;
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

Mask known_in_both(const Dem& a, const Dem& b) {
  Mask both = a.known;
  for (std::size_t i = 0; i < both.cells().size(); ++i)
    both.cells()[i] = a.known.cells()[i] && b.known.cells()[i];
  return both;
}

Mask without_known(const Mask& comparable, const Dem& sampled) {
  Mask where = comparable;
  for (std::size_t i = 0; i < where.cells().size(); ++i)
    if (sampled.known.cells()[i]) where.cells()[i] = 0;
  return where;
}

Scores score(const Dem& truth, const Dem& got, const Mask& comparable, const Mask& filled,
             const Raster<float>& sigma, const Run& run) {
  const Size size = truth.size();
  const std::size_t compared = count(comparable);
  Scores scores;
  scores.unfilled = count(truth.known) - compared;
  const auto spacing = spacing_by_row(truth.ref, size);
  const Raster<float> truth_z = completed(truth, got.z), got_z = completed(got, truth.z);
  scores.all = compare(truth_z, got_z, comparable, spacing, run.part(0, 0.4));
  if (!filled.empty()) scores.filled = compare(truth_z, got_z, filled, spacing, run.part(0.4, 0.7));

  if (!sigma.empty())
    scores.calibration = calibration(truth_z, got_z, filled.empty() ? comparable : filled, sigma);

  // A spectrum needs whole surfaces, large enough to hold a few waves.
  if (compared == size.cells() && size.cols >= 16 && size.rows >= 16) {
    run.report(0.7, "spectrum");
    scores.truth = power_spectrum(truth.z, truth.spacing);
    scores.got = power_spectrum(got.z, truth.spacing);
  }
  return scores;
}

Json as_json(const Scores& s) {
  Json json{{"all", as_json(s.all)},
            {"filled", s.filled ? as_json(*s.filled) : Json()},
            {"unfilled_cells", s.unfilled},
            {"calibration", Json()},
            {"spectrum", Json::array()}};
  if (const auto& c = s.calibration)
    json["calibration"] = {{"cells", c->cells},
                           {"within_1_sigma", c->within_1},
                           {"within_2_sigma", c->within_2},
                           {"within_3_sigma", c->within_3},
                           {"rms_ratio", c->rms_ratio}};
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    json["spectrum"].push_back({{"wavelength_m", s.truth[i].wavelength_m},
                                {"truth_m4", s.truth[i].power_m2},
                                {"got_m4", s.got[i].power_m2},
                                {"waves", s.truth[i].waves}});
  return json;
}

}  // namespace dem::app
