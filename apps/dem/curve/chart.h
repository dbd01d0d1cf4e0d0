#pragma once
// Line charts as SVG text.

#include <string>
#include <vector>

namespace dem::app {

/// One line, or only its marks; values must be finite (positive on a logarithmic axis).
struct Series {
  std::string name;
  std::vector<double> x, y;
  bool line = true, marks = true, dashed = false;
};

struct Axis {
  std::string label;
  bool log = false;
  bool reversed = false;        ///< large values at the left
  std::vector<double> ticks{};  ///< "": chosen
};

/// One picture of lines, each named at its right end.
struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<double> levels{};  ///< y of dotted lines across
};

/// Panels side by side under one title. The i-th series of each panel has the i-th colour; colours
/// can be told apart by colour-blind people, and each has a mark of its own.
std::string svg_chart(const std::string& title, const std::string& note,
                      const std::vector<Panel>& panels);

}  // namespace dem::app
