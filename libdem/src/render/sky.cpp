#include "render/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "numeric/parallel.h"

namespace dem::render {
using namespace numeric;
namespace {

constexpr double kMostCells = 1.2e6;  // more detail than a picture shows
constexpr int kDirections = 16;
constexpr std::array kDistances{1, 2, 3, 5, 8, 12, 18, 27, 40};

/// A cell that may stand over the horizon.
struct Neighbour {
  int cols, rows;
  double slope_of_metre;  // 1 / its distance in metres
};

std::vector<std::vector<Neighbour>> neighbours(Spacing cell, int step, double exaggeration) {
  std::vector<std::vector<Neighbour>> all;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / kDirections;
    std::vector<Neighbour> line;
    for (const int distance : kDistances) {
      const int cols = int(std::lround(distance * std::cos(angle))) * step;
      const int rows = int(std::lround(distance * std::sin(angle))) * step;
      line.push_back({cols, rows, exaggeration / std::hypot(cols * cell.dx_m, rows * cell.dy_m)});
    }
    all.push_back(std::move(line));
  }
  return all;
}

}  // namespace

SkyView::SkyView(const Dem& dem, double exaggeration, const Run& run) {
  step = std::max(1, int(std::ceil(std::sqrt(double(dem.size().cells()) / kMostCells))));
  const auto lines = neighbours(dem.spacing, step, exaggeration);
  share = Raster<float>({(dem.z.cols() - 1) / step + 1, (dem.z.rows() - 1) / step + 1}, 1);
  const auto seen = [&](int col, int row) {
    const double here = dem.z(col, row);
    double sum = 0;
    for (const auto& line : lines) {
      double horizon = 0;  // its slope
      for (const auto& [cols, rows, slope_of_metre] : line) {
        const int c = col + cols, r = row + rows;
        if (!dem.z.contains(c, r)) break;
        if (dem.known(c, r))
          horizon = std::max(horizon, (double(dem.z(c, r)) - here) * slope_of_metre);
      }
      sum += 1 / (1 + horizon * horizon);
    }
    return float(sum / kDirections);
  };
  constexpr int rows_at_once = 64;
  for (int first = 0; first < share.rows(); first += rows_at_once) {
    run.report(double(first) / share.rows(), "sky");
    parallel_for(first, std::min(first + rows_at_once, share.rows()), 4, [&](int j) {
      for (int i = 0; i < share.cols(); ++i)
        if (dem.known(i * step, j * step)) share(i, j) = seen(i * step, j * step);
    });
  }
}

double SkyView::operator()(double col, double row) const {
  const double x = std::clamp(col / step, 0.0, share.cols() - 1.0);
  const double y = std::clamp(row / step, 0.0, share.rows() - 1.0);
  const int i = std::min(int(x), std::max(0, share.cols() - 2)),
            i1 = std::min(i + 1, share.cols() - 1);
  const int j = std::min(int(y), std::max(0, share.rows() - 2)),
            j1 = std::min(j + 1, share.rows() - 1);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * double(share(i, j)) + u * double(share(i1, j))) +
         v * ((1 - u) * double(share(i, j1)) + u * double(share(i1, j1)));
}

}  // namespace dem::render
