#include "dem/io/geodesy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace dem {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const std::string kWgs84 =
    "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM["
    "\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
const std::string kSphere =
    "GEOGCS[\"sphere\",DATUM[\"d\",SPHEROID[\"s\",6371000,0]],PRIMEM[\"Greenwich\",0],UNIT["
    "\"degree\",0.0174532925199433]]";

/// Nodes of the degree north-east of (lon, lat).
GeoRef tile(double lon, double lat, int n, const std::string& wkt = kWgs84) {
  return {{lon, 1.0 / (n - 1), 0, lat + 1, 0, -1.0 / (n - 1)}, wkt};
}

TEST(Geodesy, OneDegreeOfLatitudeHasItsKnownLength) {
  // Meridian degrees centred on 0, 45 and 90 degrees of WGS 84, from the series for the meridian
  // arc.
  const auto degree_m = [](double lat) {
    const double e2 = 0.00669437999014, s = std::sin(lat * kDegree);
    return 6378137 * (1 - e2) / std::pow(1 - e2 * s * s, 1.5) * kDegree;
  };
  for (const double lat : {0.0, 44.5, 60.0}) {
    const GeoRef ref{{10, 0.01, 0, lat, 0, -0.01}, kWgs84};
    // 1e-8: the curvature changes by that little within a hundredth of a degree.
    EXPECT_NEAR(spacing_by_row(ref, {3, 1})[0].dy_m * 100 / degree_m(lat), 1, 1e-8) << lat;
  }
  EXPECT_NEAR(degree_m(44.5), 111123, 1);
}

TEST(Geodesy, ADegreeOfLongitudeShrinksWithTheParallel) {
  const double e2 = 0.00669437999014;
  const auto spacing = spacing_by_row(tile(7, 44, 1201), {1201, 1201});
  for (const int row : {0, 600, 1200}) {
    const double lat = (45 - row / 1200.0) * kDegree, s = std::sin(lat);
    const double radius = 6378137 * std::cos(lat) / std::sqrt(1 - e2 * s * s);
    // 1e-9: the geodesic is that little shorter than the parallel over three seconds.
    EXPECT_NEAR(spacing[std::size_t(row)].dx_m / (radius * kDegree / 1200), 1, 1e-9);
  }
  EXPECT_LT(spacing[0].dx_m, spacing[1200].dx_m);
}

TEST(Geodesy, OnASphereLengthsAreArcs) {
  const auto spacing = spacing_by_row(tile(0, 0, 11, kSphere), {11, 11});
  EXPECT_NEAR(spacing[10].dx_m, 6371000 * 0.1 * kDegree, 1e-6);  // row 10 is the equator
  for (const Spacing& s : spacing) EXPECT_NEAR(s.dy_m, 6371000 * 0.1 * kDegree, 1e-6);
}

TEST(Geodesy, AtThePolesCellsAreNarrowButNotEmpty) {
  const auto north = spacing_by_row(tile(0, 89, 1201), {1201, 1201});
  EXPECT_GT(north[0].dx_m, 0);
  EXPECT_LT(north[0].dx_m, north[1].dx_m);
  EXPECT_NEAR(north[0].dy_m, north[1].dy_m, 1e-6);
  const auto south = spacing_by_row(tile(0, -90, 1201), {1201, 1201});
  EXPECT_NEAR(south[1200].dx_m, north[0].dx_m, 1e-6);
  EXPECT_GT(cell_area_m2(tile(0, 89, 1201), 0, 0), 0);
}

TEST(Geodesy, ProjectedUnitsBecomeMetres) {
  const std::string feet =
      "PROJCS[\"p\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
      "84\",6378137,298.257223563]]"
      ",PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_"
      "Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER["
      "\"scale_factor\",1],PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],UNIT["
      "\"foot\",0.3048]]";
  const GeoRef ref{{0, 100, 0, 0, 0, -50}, feet};
  EXPECT_FALSE(is_geographic(ref));
  EXPECT_NEAR(middle_spacing(ref, {9, 9}).dx_m, 30.48, 1e-12);
  EXPECT_NEAR(spacing_by_row(ref, {9, 9})[4].dy_m, 15.24, 1e-12);
  EXPECT_NEAR(cell_area_m2(ref, 0, 0), 30.48 * 15.24, 1e-9);
}

TEST(Geodesy, WithoutCrsUnitsAreMetres) {
  const GeoRef turned{{0, 3, 4, 0, 4, -3}, ""};
  EXPECT_EQ(middle_spacing(turned, {5, 5}), (Spacing{5, 5}));
  EXPECT_EQ(cell_area_m2(turned, 2, 2), 25);
  EXPECT_FALSE(is_geographic(turned));
}

TEST(Geodesy, CellsCoverTheEarth) {
  // One column of a world grid, cells 1 degree high and 360 wide, must add up to the ellipsoid.
  const GeoRef world{{0, 360, 0, 89.5, 0, -1}, kWgs84};
  double sum = 0;
  for (int row = 0; row < 180; ++row) sum += cell_area_m2(world, 0, row);
  EXPECT_NEAR(sum / 5.10065621724e14, 1, 1e-11);  // area of WGS 84, twelve digits
}

TEST(Geodesy, AreaOfASmallCellIsWidthTimesHeight) {
  const GeoRef ref = tile(7, 44, 3601);
  const Spacing s = spacing_by_row(ref, {3601, 3601})[1800];
  EXPECT_NEAR(cell_area_m2(ref, 0, 1800) / (s.dx_m * s.dy_m), 1, 1e-7);
}

TEST(Geodesy, TurnedGeographicGridsAreMeasuredAlongTheirAxes) {
  // A quarter turn: columns run north, rows run east.
  const GeoRef straight{{10, 0.01, 0, 45, 0, -0.02}, kWgs84};
  const GeoRef turned{{10, 0, 0.01, 45, 0.02, 0}, kWgs84};
  const Spacing a = middle_spacing(straight, {1, 1}), b = middle_spacing(turned, {1, 1});
  EXPECT_NEAR(a.dx_m, b.dy_m, 1e-4);
  EXPECT_NEAR(a.dy_m, b.dx_m, 1e-4);
  EXPECT_NEAR(cell_area_m2(straight, 0, 0), cell_area_m2(turned, 0, 0), 1e-3);
}

TEST(Geodesy, DegenerateGeoreferencesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const GeoRef flat{{0, 1, 0, 0, 0, 0}, ""};
  const GeoRef bad{{0, nan, 0, 0, 0, -1}, ""};
  const GeoRef metres_as_degrees{{500000, 30, 0, 4600000, 0, -30}, kWgs84};
  const GeoRef nonsense{{0, 1, 0, 0, 0, -1}, "nonsense"};
  for (const GeoRef& ref : {flat, bad, metres_as_degrees, nonsense}) {
    EXPECT_THROW(spacing_by_row(ref, {2, 2}), std::invalid_argument);
    EXPECT_THROW(middle_spacing(ref, {2, 2}), std::invalid_argument);
    EXPECT_THROW(cell_area_m2(ref, 0, 0), std::invalid_argument);
  }
}

}  // namespace
}  // namespace dem
