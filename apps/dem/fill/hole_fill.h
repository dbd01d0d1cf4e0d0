#pragma once
// Filling a DEM hole by hole, and what is to be told of it.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common.h"
#include "dem/holes.h"
#include "dem/methods.h"
#include "fill/fill_layers.h"
#include "fill/hole_choice.h"

namespace dem::app {

/// What is to be done, whatever the raster.
struct FillRequest {
  ChosenMethod method;
  HoleChoice choice;
  bool whole = false;       ///< one problem, however few cells are unknown
  bool rim_errors = false;  ///< tell how well hidden rim cells are found
  bool keep_sigma = false, keep_origin = false;
  std::vector<std::string> aux{};  ///< auxiliary DEMs
  std::string water{};             ///< polygons of water
};

/// What became of one hole.
struct HoleOutcome {
  Verdict verdict = Verdict::fill;
  std::size_t method_cells = 0, guide_cells = 0, water_cells = 0, left_cells = 0;
  int guide = -1;
  float rim_error_m = 0, offset_m = 0;  ///< NaN: not known
  double seconds = 0;                   ///< of its window, shared by the holes in it
  std::size_t window_cells = 0;
};

/// What was done, for the report.
struct FillOutcome {
  std::vector<Hole> holes;
  std::vector<HoleOutcome> outcomes;  ///< of each hole
  std::size_t unknown = 0, filled = 0, left = 0, windows = 0;
  std::size_t left_at_border = 0, left_by_choice = 0;  ///< cells; the latter without the former
  std::size_t border_holes = 0, border_cells = 0, water_cells = 0, guide_cells = 0;
  bool known_kept = true;  ///< the checksum of the known cells is what it was
  std::uint64_t known_checksum = 0;
  std::size_t memory_needed = 0;  ///< bytes for the largest window that did not fit; 0: all did
  double seconds = 0;
  std::vector<Figure> figures;       ///< of the method, when there was one window
  bool contour_lines = false;        ///< the method found contour lines in a window
  std::vector<FillLayers::Fit> aux;  ///< of the auxiliary DEMs
  Raster<float> sigma;
  Raster<std::uint8_t> origin;
};

/// The plan for a list of holes: verdicts, windows, counts. Sets everything that needs no heights.
struct FillPlan {
  std::vector<Verdict> verdicts;
  std::vector<HoleWindow> windows;
  bool whole = false;
};
FillPlan plan_fill(const FillRequest& request, const std::vector<Hole>& holes, Size raster,
                   const GeoRef& ref, FillOutcome& outcome);

/// Fills a window by a method with its settings.
std::function<Filled(const Dem&, const Run&)> filler(const ChosenMethod& chosen);

/// Adds what a patch says to the outcome.
void account(const HolePatch& patch, const FillPlan& plan, FillOutcome& outcome);

/// Fills the chosen holes of `dem` in place.
FillOutcome fill_holes_of(Dem& dem, const FillRequest& request, const Run& run);

/// A part of what was filled, to be looked at.
struct FilledPart {
  Dem dem;                      ///< cells left void are unknown
  Raster<std::uint8_t> origin;  ///< CellOrigin
  Raster<float> sigma{};        ///< empty: not asked for
};

/// What was done, as `dem fill --json` prints it, and `libdem.fill` reports it.
Json as_json(const FillOutcome& outcome, const std::string& method, const Settings& settings);

/// The table of holes as JSON.
Json hole_table(const FillOutcome& outcome, const std::string& method);

}  // namespace dem::app
