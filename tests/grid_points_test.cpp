#include "dem/io/grid_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "dem/io/methods.h"
#include "dem/io/rasters.h"

namespace dem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Hills, with a step of 40 m east of x = 203.
float ground(double x, double y) {
  return float(300 + 20 * std::sin(x / 40) + 15 * std::cos(y / 55) + (x < 203 ? 0 : 40));
}

Points scattered() {
  Points points;
  for (int i = 0; i < 700; ++i) {
    const double x = std::fmod(i * 157.31, 400), y = std::fmod(i * 89.17, 300);
    points.x.push_back(x), points.y.push_back(y), points.z.push_back(ground(x, y));
  }
  return points;
}

/// Circles around (500, 500): a cone with a level every 20 m.
std::vector<ContourLine> cone() {
  std::vector<ContourLine> lines;
  for (int level = 20; level < 100; level += 20) {
    ContourLine line{double(level), {}, {}};
    for (int a = 0; a < 57; ++a) {
      line.x.push_back(500 + 5 * (100 - level) * std::cos(a / 9.));
      line.y.push_back(500 + 5 * (100 - level) * std::sin(a / 9.));
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

class GridPoints : public testing::Test {
 protected:
  GridPoints()
      : dir_(fs::temp_directory_path() /
             ("dem-grid-" +
              std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(dir_);
    fs::create_directory(dir_);
    request_.method = find_method(all_fill_methods(), default_grid_method(false));
    request_.lattice.cell = CellSize{10};
  }
  ~GridPoints() override { fs::remove_all(dir_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (dir_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  /// Points as a file: 17 digits hold a double, 9 a float.
  std::string as_text(const Points& points) const {
    std::string text = "x,y,z\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
      char row[99];
      std::snprintf(row, sizeof row, "%.17g,%.17g,%.9g\n", points.x[i], points.y[i],
                    double(points.z[i]));
      text += row;
    }
    return write("p.csv", text);
  }

  /// Without a coordinate system, GeoJSON is in degrees.
  std::string as_geojson(const std::string& name, const std::vector<ContourLine>& lines,
                         const std::string& crs = "EPSG:4326") const {
    std::string features;
    for (const ContourLine& line : lines) {
      features += features.empty() ? "" : ",";
      features +=
          "{\"type\":\"Feature\",\"properties\":{\"height\":" + std::to_string(int(line.level_m)) +
          "},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[";
      for (std::size_t i = 0; i < line.x.size(); ++i) {
        char place[99];
        std::snprintf(place, sizeof place, "%s[%.17g,%.17g]", i == 0 ? "" : ",", line.x[i],
                      line.y[i]);
        features += place;
      }
      features += "]}}";
    }
    return write(
        name,
        "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" +
            crs + "\"}},\"features\":[" + features + "]}");
  }

  /// Both inputs give the same cells.
  void expect_same(const GridInput& file, const GridInput& memory) const {
    const GridResult a = grid_points(file, request_), b = grid_points(memory, request_);
    EXPECT_EQ(a.dem.z, b.dem.z);
    EXPECT_EQ(a.dem.known, b.dem.known);
    EXPECT_EQ(a.dem.breaks, b.dem.breaks);
    EXPECT_EQ(a.dem.ref, b.dem.ref);
    EXPECT_EQ(a.misfit.rms_m, b.misfit.rms_m);
    EXPECT_EQ(a.points.lattice_from, b.points.lattice_from);
    EXPECT_GT(a.points.binned.counts.cells, 100u);
  }

  void refuses(const GridInput& input, const std::string& says) const {
    EXPECT_THAT([&] { grid_points(input, request_); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  }

  fs::path dir_;
  GridRequest request_;
};

TEST_F(GridPoints, FilesAndMemoryGiveTheSameBits) {
  const Points points = scattered();
  expect_same({as_text(points)}, {points});
  request_.lattice = {};
  expect_same({as_text(points)}, {points});
  request_.fill = false;
  expect_same({as_text(points)}, {points});
}

TEST_F(GridPoints, PointsAreTransformedTheSameWay) {
  Points points = scattered();
  for (double& x : points.x) x += 500000;
  for (double& y : points.y) y += 5200000;
  const PointReadOptions read{.crs = "EPSG:32632", .to_crs = "EPSG:25832"};
  expect_same({as_text(points), false, read}, {points, false, read});
  const PointReadOptions degrees{.crs = "EPSG:32632", .to_crs = "EPSG:4326"};
  expect_same({as_text(points), false, degrees}, {points, false, degrees});
}

TEST_F(GridPoints, BreaklinesInAFileAndInMemoryGiveTheSameBits) {
  const Points points = scattered();
  const ContourLine wall{0, {203, 203}, {-50, 350}};
  const std::vector<WorldLine> lines{{wall.x, wall.y}};
  const std::string plain = as_geojson("plain.geojson", {wall});
  expect_same({points, false, {}, plain}, {points, false, {}, lines});
  const PointReadOptions read{.crs = "EPSG:32632", .to_crs = "EPSG:3035"};
  const std::string placed = as_geojson("placed.geojson", {wall}, "EPSG:32632");
  expect_same({points, false, read, placed}, {points, false, read, lines});

  const GridResult cut = grid_points({points, false, {}, lines}, request_);
  EXPECT_NE(cut.dem.z, grid_points({points}, request_).dem.z);
  EXPECT_TRUE(cut.points.closed_off.empty());
}

TEST_F(GridPoints, ContoursInAFileAndInMemoryGiveTheSameBits) {
  request_.method = find_method(all_fill_methods(), default_grid_method(true));
  request_.lattice.bounds = Bounds{0, 0, 1000, 1000};
  const PointReadOptions read{.crs = "EPSG:32632"};
  const GridInput memory{cone(), false, read};
  expect_same({as_geojson("c.geojson", cone()), true, read}, memory);
  const GridResult made = grid_points(memory, request_);
  EXPECT_TRUE(made.contour_lines);
  EXPECT_NEAR(made.dem.z(20, 50), 100 - 295 / 5., 2);  // 295 m west of the summit
}

TEST_F(GridPoints, AreasWithoutPointsBehindBreaklinesAreNamed) {
  const std::vector<WorldLine> pond{{{101, 101, 124, 124, 101}, {101, 124, 124, 101, 101}}};
  Points points = scattered();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::abs(points.x[i] - 112) < 13 && std::abs(points.y[i] - 112) < 13)
      points.z[i] = std::numeric_limits<float>::quiet_NaN();
  request_.lattice.bounds = Bounds{0, 0, 400, 300};
  const GridResult made = grid_points({points, false, {}, pond}, request_);
  ASSERT_EQ(made.points.closed_off.size(), 1u);
  EXPECT_EQ(made.points.closed_off[0].cells, 4u);
  EXPECT_EQ(made.points.closed_off[0].x, 110);
  EXPECT_EQ(made.points.closed_off[0].y, 110);
  EXPECT_GT(made.points.source.without_z, 0u);
}

TEST_F(GridPoints, WhatIsWrongIsNamed) {
  const Points points = scattered();
  refuses({Points{}}, "no point has a finite x, y and z");
  refuses({Points{{1, 2}, {1}, {1, 2}, {}, {}}}, "points.y has 1 values; must have 2, as z");
  refuses({points, true}, "contours");
  refuses({std::vector<ContourLine>{{10, {1, 2}, {1}}}}, "line 0 has 2 values of x and 1 of y");
  refuses({points, false, {.crs = "EPSG:4326"}}, "are no longitude and latitude");
  refuses({points, false, {}, std::vector<WorldLine>{{{9, 9}, {9000, 9001}}}},
          "breaklines: none of its lines passes between two cells");
  refuses({points, false, {}, std::vector<WorldLine>{{{1}, {1}}}}, "breaklines: line 0");
  request_.method = find_method(all_fill_methods(), "mcmd");
  refuses({points, false, {}, std::vector<WorldLine>{{{203, 203}, {0, 300}}}},
          "breaklines: method mcmd knows none");
  request_.lattice.bounds = Bounds{9000, 0, 9400, 300};
  refuses({points}, "none of its 700 points lies on the lattice");
  request_.lattice.cell.reset();
  refuses({points}, "bounds needs cell");
  request_.lattice = {.nodes = true};
  refuses({points}, "nodes is for bounds");
  request_.lattice = {};
  refuses({cone()}, "contours needs cell");
  request_.lattice = {.like = Lattice{{}, {9, 9}, {}}, .cell = CellSize{10}};
  refuses({points}, "like says it all");
  request_.lattice = {.cell = CellSize{10}};
  request_.bin.outliers = 10;
  refuses({cone()}, "outliers is for points");
}

}  // namespace
}  // namespace dem
