#pragma once
// Which voids of a raster are filled, and why the others are not.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dem/fields.h"
#include "dem/holes.h"

namespace dem {

/// The conditions that a void must meet to be filled. All are filled by default.
struct HoleChoice {
  bool inner_only = false;               ///< leave voids that touch the border of the raster
  std::optional<double> max_area_km2;    ///< largest area on the ground
  std::optional<double> max_distance_m;  ///< largest distance of a cell to the nearest known cell
  std::optional<std::size_t> min_cells;  ///< smallest number of cells
  std::string where;                     ///< a condition in words, see parse_hole_filter; "": none
};

std::vector<Field> fields(HoleChoice& choice);

/// Throws std::invalid_argument when a limit or the condition cannot be meant.
void check(const HoleChoice& choice);

/// The choice in words, equal for equal choices: to know a stopped run by.
std::string text_of(const HoleChoice& choice);

/// Why a void is not filled; `fill`: it is. All but `memory` are the user's choice.
enum class Verdict : std::uint8_t {
  fill,
  inner_only,
  max_area_km2,
  min_cells,
  max_distance_m,
  where,
  region,
  memory
};
constexpr std::size_t verdicts = 8;

/// "inner_only": the name of the option that decided.
std::string_view name_of(Verdict verdict);

/// The verdict on each void. `in_region`: only voids with a marked cell are filled.
/// Throws std::invalid_argument for a bad condition.
std::vector<Verdict> judge(const HoleChoice& choice, const std::vector<Hole>& holes,
                           bool in_region);

}  // namespace dem
