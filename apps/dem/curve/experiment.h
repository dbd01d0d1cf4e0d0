#pragma once
// The experiment behind `dem curve` and `dem reproduce`: remove cells at random, fill, compare.

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "common.h"
#include "curve/chart.h"
#include "dem/evaluate.h"
#include "dem/methods.h"

namespace dem::app {

/// Median times of a call made several times over.
struct Times {
  double wall_s = 0;
  double cpu_s = 0;  ///< of all threads together
};

double median(std::vector<double> values);

/// Calls `work()` `repeats` times; its last value and the median times.
template <class Work>
auto timed(int repeats, Work work) {
  std::vector<double> wall, cpu;
  decltype(work()) value{};
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const auto cpu_start = std::clock();
    value = work();
    cpu.push_back(double(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return std::pair(std::move(value), Times{median(wall), median(cpu)});
}

/// How one method did at one rate.
struct Score {
  std::string method;
  double percent = 0;    ///< kept, of the known cells
  std::size_t kept = 0;  ///< the same in cells
  Errors errors;         ///< over the removed cells
  Times times;
};

struct CurveOptions {
  std::vector<std::string> methods = curve_methods();
  std::vector<double> percents{99, 95, 90, 80, 70, 60, 50, 40, 30, 20, 10, 5, 3.4, 2, 1};
  int repeats = 3;
  std::uint64_t seed = 1;
  std::vector<Score> rivals{};  ///< of other programs, measured elsewhere: into the same picture

  /// Every fill method but that for contour lines, and those presets called `paper`.
  static std::vector<std::string> curve_methods();
};

/// The scores in a file that scripts/compare.py or write_curve made: those of other programs.
/// Throws IoError.
std::vector<Score> read_rivals(const std::string& path);

/// Throws std::invalid_argument unless every method exists and every rate leaves cells to fill.
void check(const CurveOptions& options);

std::vector<Score> measure_curve(const Dem& truth, const CurveOptions& options, const Run& run);

/// Error and time against the cells kept, to be drawn.
std::vector<Panel> curve_panels(const CurveOptions& options, const std::vector<Score>& scores);

/// Names of the files that write_curve makes.
inline constexpr const char* kCurveFiles[] = {"curves.csv", "curves.json", "curves.svg"};

/// Writes curves.csv, curves.json and curves.svg; returns what curves.json holds.
Json write_curve(const OutputFolder& folder, const std::string& title, const Dem& truth,
                 const CurveOptions& options, const std::vector<Score>& scores, bool overwrite);

/// RMSE and time as a table, a row for each rate; the rivals' columns last.
std::string curve_table(std::vector<Score> scores, const CurveOptions& options);

}  // namespace dem::app
