// The sparse DEMs that the figures start from.

#include "reproduce/sketches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dem::app {
namespace {

constexpr int kMiddle = kSide / 2;

struct Point {
  double x, y, height;
};

/// Lines through the points, heights in proportion between them.
void put_line(Dem& dem, const std::vector<Point>& points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point a = points[i - 1], b = points[i];
    const int steps =
        std::max(1, int(std::ceil(std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)))));
    for (int s = 0; s <= steps; ++s) {
      const double t = s / double(steps);
      put(dem, int(std::lround(std::lerp(a.x, b.x, t))), int(std::lround(std::lerp(a.y, b.y, t))),
          float(std::lerp(a.height, b.height, t)));
    }
  }
}

/// A line and its side branches, a pair every 30 cells: `rise` metres a cell away from the line.
void put_branched(Dem& dem, const std::vector<Point>& points, double rise) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point a = points[i - 1], b = points[i];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double along_x = (b.x - a.x) / length, along_y = (b.y - a.y) / length;
    for (double at = 12; at < length; at += 30)
      for (double side : {-1.0, 1.0}) {
        const double reach = 28 + 9 * std::sin(at + 2 * side);  // uneven, as nature is
        const Point foot{a.x + at * along_x, a.y + at * along_y,
                         std::lerp(a.height, b.height, at / length)};
        put_line(dem, {foot,
                       {foot.x + reach * (0.5 * along_x - side * along_y),
                        foot.y + reach * (0.5 * along_y + side * along_x),
                        std::max(2.0, foot.height + rise * reach)}});
      }
  }
  put_line(dem, points);
}

}  // namespace

Dem blank(Size size) { return {Raster<float>(size), Mask(size), {}, {}}; }

void put(Dem& dem, int col, int row, float height) {
  if (!dem.z.contains(col, row)) return;
  dem.z(col, row) = height;
  dem.known(col, row) = 1;
}

Dem five_points() {
  Dem dem = blank({kSide, kSide});
  for (int col : {0, kSide - 1})
    for (int row : {0, kSide - 1}) put(dem, col, row, kMedium);
  put(dem, kMiddle, kMiddle, kHigh);
  return dem;
}

Dem circle_and_segments() {
  Dem dem = blank({kSide, kSide});
  const double radius = kSide * 0.22;
  for (int step = 0; step < 4000; ++step) {
    const double angle = step * 2 * std::numbers::pi / 4000;
    put(dem, int(std::lround(kMiddle + radius * std::cos(angle))),
        int(std::lround(kMiddle + radius * std::sin(angle))), kHigh);
  }
  const int from = kSide / 4, to = kSide * 7 / 16;  // distance from the centre, along each axis
  for (int d = from; d <= to; ++d) {
    put(dem, kMiddle + d, kMiddle - d, kMedium);
    put(dem, kMiddle - d, kMiddle - d, kMedium);
    put(dem, kMiddle + d, kMiddle + d, kMedium);
    put(dem, kMiddle - d - 1, kMiddle + d, kMedium);
  }
  return dem;
}

Dem skeleton() {
  constexpr double ridge = -0.9, river = 0.5;
  Dem dem = blank({kSide, kSide});
  put_branched(dem, {{40, 90, 40}, {110, 140, 90}, {190, 150, 140}, {270, 120, 110}, {350, 60, 50}},
               ridge);
  put_branched(dem,
               {{190, 150, 140}, {230, 230, 105}, {300, 290, 120}, {390, 300, 80}, {470, 260, 40}},
               ridge);
  put_branched(dem, {{300, 290, 120}, {290, 380, 85}, {320, 470, 45}}, ridge);
  put_branched(dem, {{110, 140, 90}, {80, 250, 70}, {70, 350, 45}, {60, 460, 35}}, ridge);
  put_branched(dem, {{240, 300, 45}, {200, 350, 28}, {190, 420, 15}, {170, 512, 5}}, river);
  put_branched(dem, {{140, 220, 40}, {160, 300, 34}, {200, 350, 28}}, river);
  put_branched(dem, {{290, 200, 45}, {360, 190, 28}, {430, 170, 15}, {512, 130, 5}}, river);
  put_branched(dem, {{370, 380, 45}, {420, 430, 22}, {512, 460, 5}}, river);
  put_branched(dem, {{130, 40, 25}, {200, 60, 15}, {250, 0, 5}}, river);
  return dem;
}

}  // namespace dem::app
