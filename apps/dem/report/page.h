#pragma once
// The page that --report writes: one file of HTML that fetches nothing. What is on it is data, as
// JSON; report.js draws it.

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "common.h"
#include "curve/chart.h"
#include "dem/evaluate.h"

namespace dem::app {

/// --report FILE.html
void add_report_option(Command& verb, std::string& path);

/// Throws when a report could not be written there: to be asked before long work. "": none is
/// wanted.
void check_report(const std::string& path, bool overwrite);

/// Seconds that the steps of a verb took.
class Stopwatch {
 public:
  /// Ends a step.
  void lap(std::string step);
  const std::vector<std::pair<std::string, double>>& laps() const { return laps_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point since_ = Clock::now();
  std::vector<std::pair<std::string, double>> laps_;
};

/// The last part of a path, for titles.
std::string name_of(const std::string& path);

using Texts = std::vector<std::pair<std::string, std::string>>;  ///< what, and its value

struct ReportPage {
  std::string title;
  std::string lead;               ///< the outcome in a sentence
  Texts figures;                  ///< the few numbers that count
  Json sections = Json::array();  ///< pictures, charts, tables
  Texts making;                   ///< inputs, outputs, settings
};

/// Writes the page whole or not at all. Throws IoError.
void write_report(const std::string& path, const ReportPage& page, const Stopwatch& watch,
                  Shell& shell);

// ---- Sections. `note` says in a sentence or two how to read them.

/// Lines over a numeric axis.
Json lines_section(const Panel& panel, std::string note);

/// Power spectra by name; null when none of them has any power.
Json spectrum_section(const std::vector<std::pair<std::string, std::vector<SpectrumBin>>>& spectra,
                      std::string note);

/// Counts of equal classes as an area under steps, beside curves over the same axis.
Json histogram_section(std::string title, std::string note, std::string x_label, double low,
                       double high, const std::vector<std::size_t>& counts,
                       const std::vector<Series>& curves);

/// Bars over classes, and below how many cells each class has.
struct Bars {
  std::string title, note, x_label, y_label;
  std::vector<std::string> classes;
  std::vector<std::pair<std::string, std::vector<double>>> series;
  std::vector<std::size_t> counts;
  std::string counts_label = "cells";
};
Json bars_section(const Bars& bars);

/// A table; cells are text, numbers or, from picture_cell(), pictures.
Json table_section(std::string title, std::string note, std::vector<std::string> columns,
                   Json rows);

/// A number for a table: `digits` after the point, "" when it is not known.
std::string decimal(double value, int digits);

/// A number that is not negative, to three digits or whole: "0.123", "12.3", "1 235".
std::string three_digits(double value);

}  // namespace dem::app
