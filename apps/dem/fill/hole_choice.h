#pragma once
// Which holes a fill takes: the options of its command line, and what they left.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common.h"
#include "dem/holes.h"

namespace dem::app {

struct HoleChoice {
  bool inner_only = false;
  std::optional<double> max_area_km2, max_distance_m;
  std::optional<std::size_t> min_cells;
  std::string where, region;

  void add_options(Command& command);

  /// How conditions are written, for the help.
  static std::string condition_help();

  /// The options in words: equal for equal choices.
  std::string text() const;
};

/// Why a hole is not filled; fill: it is. All but `memory` are the user's choice.
enum class Verdict : std::uint8_t {
  fill,
  at_border,
  too_large,
  too_small,
  too_deep,
  where,
  region,
  memory
};
std::string_view text_of(Verdict verdict);

/// The verdict on each hole. `in_region`: cells of the region were marked when they were found.
/// Throws std::invalid_argument for a bad condition.
std::vector<Verdict> judge(const HoleChoice& choice, const std::vector<Hole>& holes);

/// Throws std::invalid_argument when the condition is none: to be asked before long work.
void check(const HoleChoice& choice);

/// "12 034 cells of 3 holes left by --inner-only, ..." or "".
std::string left_text(const std::vector<Hole>& holes, const std::vector<Verdict>& verdicts);

}  // namespace dem::app
