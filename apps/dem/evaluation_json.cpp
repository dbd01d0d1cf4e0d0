#include "evaluation_json.h"

namespace dem::app {
namespace {

Json as_json(const Errors& e) {
  Json json{{"cells", e.cells}};
  for (const auto& m : measures) json[std::string(m.name) + "_" + m.unit] = e.*m.value;
  return json;
}

}  // namespace

Json as_json(const Evaluation& s) {
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
