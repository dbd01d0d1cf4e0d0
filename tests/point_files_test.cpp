#include "dem/io/point_files.h"

#include <gdal.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "dem/io/lattices.h"
#include "dem/io/rasters.h"

namespace dem {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class PointFiles : public testing::Test {
 protected:
  PointFiles()
      : dir_(fs::temp_directory_path() /
             ("dem-points-" +
              std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(dir_);
    fs::create_directory(dir_);
  }
  ~PointFiles() override { fs::remove_all(dir_); }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  Points read(const std::string& file, const PointReadOptions& options = {}) {
    Points all;
    source_ = read_points(file, options, [&](const Points& part) {
      const auto join = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      join(all.x, part.x), join(all.y, part.y), join(all.z, part.z);
      join(all.sigma, part.sigma), join(all.weight, part.weight);
    });
    return all;
  }
  Points text(const std::string& content, const PointReadOptions& options = {}) {
    return read(write("p.csv", content), options);
  }
  void fails(const std::string& content, const std::string& says,
             const PointReadOptions& options = {}) {
    EXPECT_THAT([&] { text(content, options); }, ThrowsMessage<IoError>(HasSubstr(says)))
        << content;
  }

  PointSource source_;
  fs::path dir_;
};

TEST_F(PointFiles, FindTheDelimiter) {
  for (const char* content :
       {"1,2,3\n4,5,6\n", "1;2;3\n4;5;6\n", "1\t2\t3\n4\t5\t6", "1|2|3\n4|5|6\n",
        "  1  2 3\n4 5\t6\r\n", "# a\n1, 2, 3\n\n4, 5, 6\n"}) {
    const Points p = text(content);
    EXPECT_THAT(p.x, ElementsAre(1, 4)) << content;
    EXPECT_THAT(p.y, ElementsAre(2, 5)) << content;
    EXPECT_THAT(p.z, ElementsAre(3, 6)) << content;
  }
}

TEST_F(PointFiles, FindColumnsByTheirUsualNames) {
  const Points p = text("\xef\xbb\xbfid,Elevation,\"Easting\",northing\nA1,7.5,100,200\n");
  EXPECT_THAT(p.x, ElementsAre(100));
  EXPECT_THAT(p.y, ElementsAre(200));
  EXPECT_THAT(p.z, ElementsAre(7.5F));
}

TEST_F(PointFiles, TakeColumnsByNameAndByNumber) {
  PointReadOptions o;
  o.x_field = "3", o.y_field = "b", o.z_field = "A", o.sigma_field = "s", o.weight_field = "5";
  const Points p = text("a b c s w\n1 2 3 0.5 4\n", o);
  EXPECT_THAT(p.x, ElementsAre(3));
  EXPECT_THAT(p.y, ElementsAre(2));
  EXPECT_THAT(p.z, ElementsAre(1));
  EXPECT_THAT(p.sigma, ElementsAre(0.5F));
  EXPECT_THAT(p.weight, ElementsAre(4));
}

TEST_F(PointFiles, ReadEveryFormOfANumberExactly) {
  const Points p =
      text("-0.1,+2.5,1e3\n.5,7.,-1.25E-2\n123456789.123456789,0.30000000000000004,1\n");
  EXPECT_THAT(p.x, ElementsAre(-0.1, 0.5, 123456789.123456789));
  EXPECT_THAT(p.y, ElementsAre(2.5, 7, 0.30000000000000004));
  EXPECT_THAT(p.z, ElementsAre(1000, -0.0125F, 1));
}

TEST_F(PointFiles, ReadDecimalCommas) {
  const Points p = text("x;y;z\n1,5;2,25;-3,75\n");
  EXPECT_THAT(p.x, ElementsAre(1.5));
  EXPECT_THAT(p.z, ElementsAre(-3.75F));
}

TEST_F(PointFiles, LeaveOutRowsWithoutANumber) {
  PointReadOptions o;
  o.nodata = -9999;
  const Points p = text("x,y,z\n1,2,3\n1,2,NaN\n1,2,\n,2,3\n1,2,-9999\n4,5,6\n", o);
  EXPECT_THAT(p.z, ElementsAre(3, 6));
  EXPECT_EQ(source_.without_z, 4u);
}

TEST_F(PointFiles, NameTheLineOfWhatIsWrong) {
  fails("x,y,z\n1,2,3\n1,2,abc\n", "line 3: z = abc; must be a number");
  fails("# made by hand\n1 2 3\n\n1 2\n", "line 4: 2 columns; must have at least 3");
  fails("x,y,z,s\n1,2,3,-1\n", "line 2: sigma = -1; must be above 0", [] {
    PointReadOptions o;
    o.sigma_field = "s";
    return o;
  }());
  std::string many = "x,y,z\n";
  for (int i = 0; i < 700000; ++i) many += "10,20,30\n";  // several blocks and stretches
  fails(many + "10,2O,30\n", "line 700002: y = 2O; must be a number");
}

TEST_F(PointFiles, SayWhatAFileWithoutPointsIs) {
  fails("", "is empty");
  fails("# nothing\n\n", "holds no points");
  fails("x,y,z\n", "holds no points");
  fails("x,y,z\n1,2,\n", "no point has an elevation (1 rows)");
  fails("a,b,c\n1,2,3\n", "no column is called x, lon or the like (its columns: a, b, c)");
  fails("lon,lat\n1,2\n", "no column is called z, elevation or the like");
  fails("1,2\n3,4\n", "2 columns; must have at least 3");
  fails(std::string("1,2,3\0\n", 7), "bytes of 0");
}

TEST_F(PointFiles, NoticeLatitudeAndLongitudeTheWrongWayRound) {
  fails("lon,lat,z\n46.5,121.75,3\n", "the wrong way round");
  PointReadOptions o;
  o.crs = "EPSG:4326";
  fails("500000,5200000,3\n", "are no longitude and latitude", o);
}

TEST_F(PointFiles, ReadDegreesMinutesSeconds) {
  const Points p =
      text("lon;lat;z\n8\xc2\xb0 30' 0\" E;46\xc2\xb0 15' 36\" N;7\n8:30W;46 15 36 S;8\n");
  ASSERT_EQ(p.size(), 2u);
  EXPECT_NEAR(p.x[0], 8.5, 1e-12);
  EXPECT_NEAR(p.y[0], 46.26, 1e-12);
  EXPECT_NEAR(p.x[1], -8.5, 1e-12);
  EXPECT_NEAR(p.y[1], -46.26, 1e-12);
  // Letters say what a number is, whatever its column.
  const Points swapped = text("x;y;z\n46:15:36N;8:30E;7\n");
  EXPECT_NEAR(swapped.x[0], 8.5, 1e-12);
}

TEST_F(PointFiles, ReadMgrsAndUtm) {
  // Both of the same place: 32T 465005 5080000.
  const Points p = text("mgrs,z\n32TMR6500580000,1\n32N 465005 5080000,2\n");
  ASSERT_EQ(p.size(), 2u);
  EXPECT_NEAR(p.x[0], p.x[1], 1e-5);  // MGRS is the middle of its square metre
  EXPECT_NEAR(p.y[0], p.y[1], 1e-5);
  EXPECT_NEAR(p.x[1], 8.55, 0.01);
  EXPECT_NEAR(p.y[1], 45.87, 0.01);
  EXPECT_THAT(crs_name(source_.crs_wkt), HasSubstr("WGS 84"));
  fails("mgrs,z\nnowhere,1\n", "position = nowhere; must be MGRS");
}

TEST_F(PointFiles, BringPointsToAnotherSystem) {
  PointReadOptions o;
  o.to_crs = "EPSG:32632";
  const Points p = text("lon,lat,z\n9,0,5\n", o);
  EXPECT_NEAR(p.x[0], 500000, 1e-6);  // the central meridian of zone 32, on the equator
  EXPECT_NEAR(p.y[0], 0, 1e-6);
  EXPECT_EQ(crs_name(source_.crs_wkt), "WGS 84 / UTM zone 32N");
  text("x,y,z\n1,2,3\n", o);
  EXPECT_THAT(source_.notes.back(), HasSubstr("no coordinate system: taken as WGS 84 / UTM"));
  o.crs = "EPSG:99999999";
  EXPECT_THAT([&] { text("1,2,3\n", o); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("must be a coordinate system")));
}

/// A LAS file of two classes; version 1.2 with format 0, or 1.4 with format 6.
std::string las(int minor, std::uint8_t classes_from) {
  const bool is_new = minor == 4;
  const std::size_t header = is_new ? 375 : 227, record = is_new ? 30 : 20, points = 3;
  std::string bytes(header + points * record, '\0');
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(&bytes[at], &value, sizeof value);
  };
  bytes.replace(0, 4, "LASF");
  bytes[24] = 1, bytes[25] = char(minor);
  put(94, std::uint16_t(header));
  put(96, std::uint32_t(header));
  bytes[104] = is_new ? 6 : 0;
  put(105, std::uint16_t(record));
  if (is_new)
    put(247, std::uint64_t(points));
  else
    put(107, std::uint32_t(points));
  for (std::size_t i = 0; i < 3; ++i) put(131 + 8 * i, 0.01), put(155 + 8 * i, 1000.0);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t at = header + i * record;
    put(at, std::int32_t(100 * i)), put(at + 4, std::int32_t(-100)),
        put(at + 8, std::int32_t(250 * i));
    bytes[at + (is_new ? 16 : 15)] = char(classes_from + i);
  }
  bytes[header + 2 * record + 15] = char(is_new ? 4 : 128 | (classes_from + 2));  // withheld
  return bytes;
}

TEST_F(PointFiles, ReadLas) {
  for (const int minor : {2, 4}) {
    Points p = read(write("p.las", las(minor, 1)));
    EXPECT_THAT(p.x, ElementsAre(1000, 1001));
    EXPECT_THAT(p.y, ElementsAre(999, 999));
    EXPECT_THAT(p.z, ElementsAre(1000, 1002.5F));
    EXPECT_EQ(source_.other_class, 1u);  // withheld
    PointReadOptions o;
    o.classes = {2};
    EXPECT_THAT(read(path("p.las"), o).z, ElementsAre(1002.5F));
    o.classes = {9};
    EXPECT_THAT([&] { read(path("p.las"), o); },
                ThrowsMessage<IoError>(HasSubstr("none of its 3")));
  }
}

TEST_F(PointFiles, RefuseBrokenAndCompressedLas) {
  std::string bytes = las(2, 1);
  write("short.las", bytes.substr(0, bytes.size() - 5));
  EXPECT_THAT([&] { read(path("short.las")); }, ThrowsMessage<IoError>(HasSubstr("cut short")));
  bytes[104] = char(0x80);
  write("zip.las", bytes);
  EXPECT_THAT([&] { read(path("zip.las")); }, ThrowsMessage<IoError>(HasSubstr("compressed LAS")));
  bytes[25] = 7;
  write("new.las", bytes);
  EXPECT_THAT([&] { read(path("new.las")); },
              ThrowsMessage<IoError>(HasSubstr("LAS 1.7; must be")));
}

TEST_F(PointFiles, ReadVectorLayers) {
  const auto geojson = [](const std::string& features) {
    return R"({"type": "FeatureCollection", "features": [)" + features + "]}";
  };
  const std::string with_field =
      R"({"type": "Feature", "properties": {"name": "a", "height": 12.5},
          "geometry": {"type": "Point", "coordinates": [8, 46]}},
         {"type": "Feature", "properties": {"name": "b", "height": null},
          "geometry": {"type": "Point", "coordinates": [9, 47]}})";
  const Points p = read(write("f.geojson", geojson(with_field)));
  EXPECT_THAT(p.x, ElementsAre(8));
  EXPECT_THAT(p.z, ElementsAre(12.5F));
  EXPECT_EQ(source_.without_z, 1u);
  EXPECT_THAT(crs_name(source_.crs_wkt), HasSubstr("WGS 84"));

  const std::string line = R"({"type": "Feature", "properties": {"name": "a"}, "geometry":
      {"type": "LineString", "coordinates": [[8, 46, 100], [8.5, 46, 101]]}})";
  EXPECT_THAT(read(write("z.geojson", geojson(line))).z, ElementsAre(100, 101));

  const std::string flat = R"({"type": "Feature", "properties": {"name": "a", "count": 3},
      "geometry": {"type": "Point", "coordinates": [8, 46]}})";
  EXPECT_THAT([&] { read(write("n.geojson", geojson(flat))); },
              ThrowsMessage<IoError>(HasSubstr("has no elevations")));
  PointReadOptions o;
  o.z_field = "name";
  EXPECT_THAT([&] { read(path("n.geojson"), o); },
              ThrowsMessage<IoError>(HasSubstr("is no number field; its number fields: count")));
}

TEST(CellSizes, AreMetresUnlessTheySayTheirUnit) {
  EXPECT_EQ(parse_cell_size("30").value, 30);
  EXPECT_EQ(parse_cell_size("30").unit, CellUnit::metres);
  EXPECT_EQ(parse_cell_size("30m").value, 30);
  EXPECT_EQ(parse_cell_size("30m").unit, CellUnit::metres);
  EXPECT_DOUBLE_EQ(parse_cell_size("3s").value, 3 / 3600.);
  EXPECT_EQ(parse_cell_size("0.001deg").unit, CellUnit::degrees);
  for (const char* text : {"-30", "m", "-1m", "0deg", "1furlong", ""})
    EXPECT_THAT([&] { parse_cell_size(text); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("must be a size above 0")))
        << text;
}

TEST(LatticeOver, HasItsEdgesOrNodesOnTheBounds) {
  const Lattice cells = lattice_over({100, 0, 160, 30}, {10, CellUnit::metres}, "", false);
  EXPECT_EQ(cells.size, (Size{6, 3}));
  EXPECT_EQ(cells.ref.to_world, (std::array<double, 6>{105, 10, 0, 25, 0, -10}));
  const Lattice nodes = lattice_over({100, 0, 160, 30}, {10, CellUnit::metres}, "", true);
  EXPECT_EQ(nodes.size, (Size{7, 4}));
  EXPECT_EQ(nodes.ref.to_world[0], 100);
}

TEST(LatticeOver, MakesCellsInMetresSquareOnDegrees) {
  const std::string degrees = crs_from_text("EPSG:4326");
  const Lattice lattice =
      lattice_over({8, 45.9, 8.2, 46.1}, {100, CellUnit::metres}, degrees, false);
  EXPECT_NEAR(lattice.spacing.dx_m, 100, 0.1);
  EXPECT_NEAR(lattice.spacing.dy_m, 100, 0.1);
  EXPECT_THAT(
      [&] {
        lattice_over({0, 0, 9, 9}, {1, CellUnit::degrees}, crs_from_text("EPSG:32632"), false);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("must be in metres")));
  EXPECT_THAT(
      [&] {
        lattice_over({0, 0, 1e6, 1e6}, {1, CellUnit::metres}, "", false);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("fewer than 2^31")));
}

TEST(LatticeFor, ReachesOverAllPoints) {
  Extent extent;
  extent.add(std::vector<double>{3.2, 1003.9, 500}, std::vector<double>{-7.1, 411.3, 20});
  extent.points = 5000;
  const Lattice lattice = lattice_for(extent, "");
  EXPECT_EQ(lattice.ref.to_world[1], 2);  // half of 9.1 m, rounded down
  EXPECT_LE(lattice.ref.to_world[0], 3.2 + 1);
  EXPECT_GE(lattice.ref.to_world[0] + 2 * (lattice.size.cols - 1), 1003.9 - 1);
  Extent line;
  line.add(std::vector<double>{1, 2}, std::vector<double>{5, 5});
  EXPECT_THAT([&] { lattice_for(line, ""); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("2 points cover no area")));
}

}  // namespace
}  // namespace dem
