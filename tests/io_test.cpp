#include "dem/io/rasters.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "dem/io/geodesy.h"

namespace dem {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the IoError that `call` throws.
std::string io_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no IoError";
}

/// Bytes of an .hgt with a slope, a ridge, negative heights and voids here and there.
std::string hgt_bytes(int n) {
  std::string bytes;
  for (int row = 0; row < n; ++row)
    for (int col = 0; col < n; ++col) {
      const int height = (col * 31 + row * row) % 4000 - 200;
      const auto h = std::uint16_t((col + 2 * row) % 11 == 3 ? -32768 : height);
      bytes += char(h >> 8);
      bytes += char(h & 255);
    }
  return bytes;
}

/// A folder of its own for each test.
class Io : public ::testing::Test {
 protected:
  Io() {
    std::string name = (fs::temp_directory_path() / "dem_io_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Io() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& e : fs::directory_iterator(folder_)) names.push_back(e.path().filename());
    return names;
  }

  /// A raster file made with GDAL alone, so that no code of ours is between.
  struct Plan {
    std::string format = "GTiff";
    GDALDataType type = GDT_Float32;
    int cols = 3, rows = 2, bands = 1;
    std::vector<double> cells{};
    std::optional<double> nodata{};
    std::vector<double> transform{500000, 30, 0, 4600000, 0, -20};
    std::function<void(GDALDatasetH)> more{};
  };
  std::string make(const std::string& name, const Plan& plan) const {
    GDALAllRegister();
    const GDALDatasetH memory = GDALCreate(GDALGetDriverByName("MEM"), "", plan.cols, plan.rows,
                                           plan.bands, plan.type, nullptr);
    if (!plan.transform.empty())
      GDALSetGeoTransform(memory, const_cast<double*>(plan.transform.data()));
    if (!plan.cells.empty()) {
      EXPECT_EQ(GDALRasterIO(GDALGetRasterBand(memory, 1), GF_Write, 0, 0, plan.cols, plan.rows,
                             const_cast<double*>(plan.cells.data()), plan.cols, plan.rows,
                             GDT_Float64, 0, 0),
                CE_None);
    }
    if (plan.nodata) GDALSetRasterNoDataValue(GDALGetRasterBand(memory, 1), *plan.nodata);
    if (plan.more) plan.more(memory);
    const GDALDatasetH file =
        GDALCreateCopy(GDALGetDriverByName(plan.format.c_str()), at(name).c_str(), memory, TRUE,
                       nullptr, nullptr, nullptr);
    EXPECT_NE(file, nullptr);
    GDALClose(file);
    GDALClose(memory);
    return at(name);
  }

  fs::path folder_;
};

/// A DEM in UTM 32N with one unknown cell.
Dem small_dem() {
  Dem dem;
  dem.z = Raster<float>({4, 3});
  dem.known = Mask({4, 3}, 1);
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col) dem.z(col, row) = 100.0f + 10.25f * float(col) - float(row);
  dem.known(2, 1) = 0;
  dem.z(2, 1) = 0;
  dem.ref.to_world = {500015, 30, 0, 4600090, 0, -20};
  return dem;
}

std::string utm_wkt() {
  return "PROJCS[\"WGS 84 / UTM zone 32N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
         "84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],"
         "PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.0174532925199433,"
         "AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]],PROJECTION[\"Transverse_"
         "Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],"
         "PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER["
         "\"false_northing\",0],UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AXIS[\"Easting\","
         "EAST],AXIS[\"Northing\",NORTH],AUTHORITY[\"EPSG\",\"32632\"]]";
}

/// A raster large enough to be interrupted, or to fill a small disk even when compressed.
Dem large_dem() {
  Dem dem;
  dem.z = Raster<float>({700, 700});
  dem.known = Mask({700, 700}, 1);
  std::uint32_t noise = 1;
  for (float& z : dem.z.cells()) z = float((noise = noise * 1664525u + 1013904223u) >> 12) / 1024;
  dem.ref.to_world = {500015, 30, 0, 4600090, 0, -30};
  return dem;
}

std::string testdata(const std::string& name) {
  const char* folder = std::getenv("DEM_TESTDATA");
  return folder ? (fs::path(folder) / name).string() : "";
}

// --- .hgt ------------------------------------------------------------------------------------

class HgtSize : public Io, public ::testing::WithParamInterface<int> {};

TEST_P(HgtSize, ComesBackByteForByteInEveryWrapping) {
  const std::string bytes = hgt_bytes(GetParam());
  put(at("N36E008.hgt"), bytes);
  const DemFile plain = read_dem(at("N36E008.hgt"));
  EXPECT_EQ(plain.dem.size(), (Size{GetParam(), GetParam()}));
  fs::create_directory(at("out"));
  for (const std::string name : {"N36E008.hgt", "N36E008.hgt.gz", "N36E008.hgt.zip"}) {
    write_dem(at("out/" + name), plain.dem, plain.source);
    const DemFile again = read_dem(at("out/" + name));
    EXPECT_EQ(again.dem.z, plain.dem.z) << name;
    EXPECT_EQ(again.dem.known, plain.dem.known) << name;
    EXPECT_EQ(again.dem.ref, plain.dem.ref) << name;
    write_dem(at("again.hgt"), again.dem, again.source, {.overwrite = true});
    EXPECT_TRUE(bytes_of(at("again.hgt")) == bytes) << name;
  }
  EXPECT_TRUE(bytes_of(at("out/N36E008.hgt")) == bytes);
}

INSTANTIATE_TEST_SUITE_P(AnySquare, HgtSize, ::testing::Values(2, 3, 7, 1201));

TEST_F(Io, HgtIsBigEndianWithVoids) {
  put(at("S12W077.hgt"), std::string("\x01\x02\x80\x00\xff\xff\x7f\xfe", 8));
  const DemFile file = read_dem(at("S12W077.hgt"));
  EXPECT_EQ(file.dem.z(0, 0), 258);
  EXPECT_EQ(file.dem.known(1, 0), 0);
  EXPECT_EQ(file.dem.z(1, 0), 0);
  EXPECT_EQ(file.dem.z(0, 1), -1);
  EXPECT_EQ(file.dem.z(1, 1), 32766);
  EXPECT_EQ(file.source.format, "HGT");
  EXPECT_EQ(file.source.type, CellType::int16);
  EXPECT_EQ(file.source.nodata, -32768);
  EXPECT_THAT(file.source.vertical_datum, HasSubstr("EGM96, assumed"));
}

TEST_F(Io, HgtNodesLieOnTheEdgesOfTheDegreeNeighboursShareThem) {
  put(at("N36E008.hgt"), hgt_bytes(5));
  put(at("N36E009.hgt"), hgt_bytes(5));
  const DemFile west = read_dem(at("N36E008.hgt")), east = read_dem(at("N36E009.hgt"));
  EXPECT_EQ(west.dem.ref.to_world, (std::array<double, 6>{8, 0.25, 0, 37, 0, -0.25}));
  EXPECT_EQ(west.dem.ref.to_world[0] + 4 * west.dem.ref.to_world[1], east.dem.ref.to_world[0]);
  EXPECT_TRUE(west.source.node_registered);
  EXPECT_TRUE(is_geographic(west.dem.ref));
}

TEST_F(Io, HgtIsFoundByAnyUsualNameOrByTile) {
  for (const std::string name : {"N36E008.hgt", "n36e008.hgt", "N36E008.SRTMGL1.hgt",
                                 "dem_n36_e008_v3.HGT", "N036E008.hgt"}) {
    put(at(name), hgt_bytes(3));
    EXPECT_EQ(read_dem(at(name)).dem.ref.to_world[3], 37) << name;
  }
  put(at("s12w077.hgt"), hgt_bytes(3));
  EXPECT_EQ(read_dem(at("s12w077.hgt")).dem.ref.to_world,
            (std::array<double, 6>{-77, 0.5, 0, -11, 0, -0.5}));
  put(at("odd.hgt"), hgt_bytes(3));
  EXPECT_EQ(read_dem(at("odd.hgt"), {.tile = "S01E000"}).dem.ref.to_world[3], 0);
  EXPECT_THAT(io_error([&] { read_dem(at("odd.hgt")); }), HasSubstr("which tile it is"));
  EXPECT_THAT(io_error([&] { read_dem(at("odd.hgt"), {.tile = "here"}); }),
              HasSubstr("tile = here; must be like N36E008"));
  put(at("N95E008.hgt"), hgt_bytes(3));
  EXPECT_THAT(io_error([&] { read_dem(at("N95E008.hgt")); }), HasSubstr("which tile it is"));
}

TEST_F(Io, ZippedHgtMayHaveAnyNameInside) {
  put(at("inner.bin.hgt"), hgt_bytes(7));
  const auto zip = [&](const std::string& name, const std::vector<std::string>& entries) -> void {
    for (const auto& entry : entries) {
      VSILFILE* f = VSIFOpenL(("/vsizip/" + at(name) + "/" + entry).c_str(), "wb");
      ASSERT_NE(f, nullptr);
      VSIFWriteL(hgt_bytes(7).data(), 1, 98, f);
      VSIFCloseL(f);
    }
  };
  zip("N36E008.SRTMGL1.hgt.zip", {"deep/inner.HGT"});
  EXPECT_EQ(read_dem(at("N36E008.SRTMGL1.hgt.zip")).dem.size(), (Size{7, 7}));
  zip("plain.zip", {"N36E008.hgt"});
  EXPECT_EQ(read_dem("/vsizip/" + at("plain.zip") + "/N36E008.hgt").dem.size(), (Size{7, 7}));
  zip("N01E001.hgt.zip", {"a.hgt", "b.hgt"});
  EXPECT_THAT(io_error([&] { read_dem(at("N01E001.hgt.zip")); }), HasSubstr("holds 2 .hgt files"));
  zip("N02E002.hgt.zip", {"readme.txt"});
  EXPECT_THAT(io_error([&] { read_dem(at("N02E002.hgt.zip")); }), HasSubstr("holds no .hgt"));
  put(at("N03E003.hgt.zip"), "not a zip");
  EXPECT_THAT(io_error([&] { read_dem(at("N03E003.hgt.zip")); }), HasSubstr("zip"));
}

TEST_F(Io, WrongHgtIsToldInOneLineWithWhatItIs) {
  const auto error = [&](const std::string& bytes, const std::string& name = "N36E008.hgt") {
    put(at(name), bytes);
    const std::string message = io_error([&] { read_dem(at(name)); });
    EXPECT_THAT(message, HasSubstr(at(name) + ": "));
    EXPECT_THAT(message, Not(HasSubstr("\n")));
    return message;
  };
  EXPECT_THAT(error(""), HasSubstr("is empty (0 bytes)"));
  EXPECT_THAT(error(hgt_bytes(1201).substr(0, 2880002)),
              AllOf(HasSubstr("has 2880002 bytes"), HasSubstr("2884802 for 1201 x 1201")));
  EXPECT_THAT(error(hgt_bytes(7).substr(0, 97)), HasSubstr("98 for 7 x 7"));
  EXPECT_THAT(error("x"), HasSubstr("looks like text: x"));
  EXPECT_THAT(error("{\"error\":\n \"no such tile\"}"),
              HasSubstr("looks like JSON: {\"error\":  \"no such tile\"}"));
  EXPECT_THAT(error("{\"e\": 1}"),
              HasSubstr("looks like JSON"));  // 8 bytes: the right size of 2 x 2
  EXPECT_THAT(error("<!DOCTYPE html><html><body>404</body></html>"), HasSubstr("an HTML page"));
  EXPECT_THAT(error("<?xml version='1.0'?><Error/>"), HasSubstr("XML"));
  EXPECT_THAT(error(std::string("PK\3\4....", 8)), HasSubstr("zip archive"));
  EXPECT_THAT(error(std::string("II*\0....", 8)), HasSubstr("is a TIFF"));
  EXPECT_THAT(error("not gzip at all", "N36E008.hgt.gz"), Not(HasSubstr("no IoError")));
  EXPECT_THAT(io_error([&] { read_dem(at("N00E000.hgt")); }), HasSubstr("N00E000.hgt: "));
  EXPECT_THAT(io_error([&] { read_dem(at("N36E008.hgt"), {.band = 2}); }), HasSubstr("has 1 band"));
}

TEST_F(Io, PlateausWhoseBytesArePrintableAreStillHeights) {
  std::string bytes;
  for (int i = 0; i < 9; ++i) bytes += "\n!";  // 2593 m everywhere
  put(at("N36E008.hgt"), bytes);
  EXPECT_EQ(read_dem(at("N36E008.hgt")).dem.z(0, 0), 2593);
}

TEST_F(Io, DamagedGzipIsAnError) {
  put(at("N36E008.hgt"), hgt_bytes(1201));
  const DemFile file = read_dem(at("N36E008.hgt"));
  write_dem(at("N36E008.hgt.gz"), file.dem, file.source);
  const std::string bytes = bytes_of(at("N36E008.hgt.gz"));
  put(at("N36E008.hgt.gz"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(io_error([&] { read_dem(at("N36E008.hgt.gz")); }), HasSubstr("N36E008.hgt.gz: "));
}

TEST_F(Io, HgtRefusesWhatItCannotHold) {
  put(at("N36E008.hgt"), hgt_bytes(5));
  const DemFile tile = read_dem(at("N36E008.hgt"));
  const auto error = [&](const Dem& dem, const WriteOptions& options = {},
                         const std::string& name = "new.hgt") {
    const std::string message = io_error([&] { write_dem(at(name), dem, {}, options); });
    EXPECT_FALSE(fs::exists(at(name)));
    return message;
  };
  EXPECT_THAT(error(small_dem()), HasSubstr("4 x 3 cells; an .hgt is a square"));
  Dem high = tile.dem;
  high.z(0, 0) = 40000;
  EXPECT_THAT(error(high), HasSubstr("elevation 40000 does not fit"));
  high.z(0, 0) = -32768;
  EXPECT_THAT(error(high), HasSubstr("void"));
  EXPECT_THAT(error(tile.dem, {.type = CellType::float32}), HasSubstr("int16 only"));
  EXPECT_THAT(error(tile.dem, {.nodata = 0.0}), HasSubstr("nodata 0"));
  EXPECT_THAT(error(tile.dem, {}, "N36E009.hgt"),
              HasSubstr("another tile than the cells, N36E008"));
  Dem moved = tile.dem;
  moved.ref.to_world[0] += 0.3;
  EXPECT_THAT(error(moved), HasSubstr("one-degree tile"));
  EXPECT_THAT(files(), ::testing::ElementsAre("N36E008.hgt"));
}

TEST_F(Io, HgtAndItsGeoTiffByGdalLieAtTheSamePlace) {
  put(at("N46E008.hgt"), hgt_bytes(1201));
  GDALAllRegister();
  const GDALDatasetH hgt = GDALOpen(at("N46E008.hgt").c_str(), GA_ReadOnly);
  ASSERT_NE(hgt, nullptr);
  GDALClose(GDALCreateCopy(GDALGetDriverByName("GTiff"), at("gdal.tif").c_str(), hgt, FALSE,
                           nullptr, nullptr, nullptr));
  GDALClose(hgt);
  const DemFile ours = read_dem(at("N46E008.hgt")), gdals = read_dem(at("gdal.tif"));
  EXPECT_EQ(ours.dem.z, gdals.dem.z);
  EXPECT_EQ(ours.dem.known, gdals.dem.known);
  EXPECT_TRUE(gdals.source.node_registered);
  // GDAL goes by way of the corner, half a cell off and back: the last bit may differ.
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(ours.dem.ref.to_world[i], gdals.dem.ref.to_world[i], 1e-13) << i;

  write_dem(at("ours.tif"), ours.dem, ours.source);
  const DemFile again = read_dem(at("ours.tif"));
  EXPECT_TRUE(again.source.node_registered);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(ours.dem.ref.to_world[i], again.dem.ref.to_world[i], 1e-13) << i;
}

TEST_F(Io, RealTileComesBackByteForByte) {
  const std::string path = testdata("N46E008.hgt");
  if (path.empty() || !fs::exists(path))
    GTEST_SKIP()
        << "needs N46E008.hgt (SRTM3, void-unfilled, from USGS EarthExplorer) in DEM_TESTDATA";
  const DemFile file = read_dem(path);
  EXPECT_EQ(file.dem.size().cells() - count(file.dem.known), 103743u);
  write_dem(at("N46E008.hgt"), file.dem, file.source);
  EXPECT_TRUE(bytes_of(at("N46E008.hgt")) == bytes_of(path));
}

// --- Through GDAL: reading
// -------------------------------------------------------------------------

TEST_F(Io, ShiftsGdalsCornerToTheCentreOnce) {
  const DemFile file = read_dem(make("a.tif", {.cells = {1, 2, 3, 4, 5, 6}}));
  EXPECT_EQ(file.dem.ref.to_world, (std::array<double, 6>{500015, 30, 0, 4599990, 0, -20}));
  EXPECT_EQ(file.dem.spacing, (Spacing{30, 20}));
  EXPECT_FALSE(file.source.node_registered);
  EXPECT_EQ(file.source.format, "GTiff");
  EXPECT_EQ(file.dem.z(2, 1), 6);
}

TEST_F(Io, SouthUpIsTurnedNorthUp) {
  const DemFile file = read_dem(
      make("a.tif", {.cells = {1, 2, 3, 4, 5, 6}, .transform = {500000, 30, 0, 4600000, 0, 20}}));
  EXPECT_EQ(file.dem.z(0, 0), 4);
  EXPECT_EQ(file.dem.z(2, 1), 3);
  EXPECT_EQ(file.dem.ref.to_world, (std::array<double, 6>{500015, 30, 0, 4600030, 0, -20}));
  write_dem(at("b.tif"), file.dem, file.source);
  EXPECT_EQ(read_dem(at("b.tif")).dem.ref, file.dem.ref);
}

TEST_F(Io, SouthUpDoublesKeepTheirOwnRows) {
  const DemFile file = read_dem(make("a.tif", {.type = GDT_Float64,
                                               .cells = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6},
                                               .transform = {500000, 30, 0, 4600000, 0, 20}}));
  EXPECT_EQ(file.source.exact(0, 0), 0.4);
  EXPECT_EQ(file.source.exact(2, 1), 0.3);
}

TEST_F(Io, TurnedGridsKeepTheirTransform) {
  const DemFile file = read_dem(
      make("a.tif", {.cells = {1, 2, 3, 4, 5, 6}, .transform = {1000, 3, 4, 2000, 4, -3}}));
  EXPECT_EQ(file.dem.ref.to_world, (std::array<double, 6>{1003.5, 3, 4, 2000.5, 4, -3}));
  EXPECT_EQ(file.dem.spacing, (Spacing{5, 5}));
  write_dem(at("b.tif"), file.dem, file.source);
  EXPECT_EQ(read_dem(at("b.tif")).dem.ref, file.dem.ref);
}

TEST_F(Io, WithoutGeoreferenceThereIsNone) {
  const DemFile file = read_dem(make("a.tif", {.cells = {1, 2, 3, 4, 5, 6}, .transform = {}}));
  EXPECT_EQ(file.dem.ref, GeoRef{});
  write_dem(at("b.tif"), file.dem, file.source);
  EXPECT_EQ(read_dem(at("b.tif")).dem.ref, GeoRef{});
}

TEST_F(Io, SeveralBandsNeedAChoice) {
  const std::string path =
      make("a.tif", {.type = GDT_Int16, .bands = 3, .more = [](GDALDatasetH d) {
                       GDALFillRaster(GDALGetRasterBand(d, 2), 7, 0);
                     }});
  EXPECT_THAT(io_error([&] { read_dem(path); }), HasSubstr("has 3 bands; one must be chosen"));
  EXPECT_EQ(read_dem(path, {.band = 2}).dem.z(0, 0), 7);
  EXPECT_THAT(io_error([&] { read_dem(path, {.band = 4}); }), HasSubstr("band 4 was asked for"));
}

TEST_F(Io, ComplexCellsAreRefused) {
  const std::string path = make("a.tif", {.type = GDT_CFloat32});
  EXPECT_THAT(io_error([&] { read_dem(path); }), HasSubstr("CFloat32"));
}

TEST_F(Io, WhatIsNoRasterIsOneLine) {
  put(at("page.tif"), "<html>404</html>");
  EXPECT_THAT(io_error([&] { read_dem(at("page.tif")); }),
              AllOf(HasSubstr("page.tif: "), HasSubstr("not recognized"), Not(HasSubstr("\n"))));
  put(at("empty.tif"), "");
  EXPECT_THAT(io_error([&] { read_dem(at("empty.tif")); }), HasSubstr("is empty (0 bytes)"));
  EXPECT_THAT(io_error([&] { read_dem(at("none.tif")); }), HasSubstr("No such file"));
}

TEST_F(Io, TruncatedGeoTiffIsAnError) {
  write_dem(at("a.tif"), large_dem());
  const std::string bytes = bytes_of(at("a.tif"));
  put(at("a.tif"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(io_error([&] { read_dem(at("a.tif")); }), HasSubstr("a.tif: "));
}

TEST_F(Io, ScaleAndOffsetAreAppliedAndSaid) {
  const DemFile file = read_dem(make("a.tif", {.type = GDT_Int16,
                                               .cells = {10, 20, 30, -1, 50, 60},
                                               .nodata = -1,
                                               .more = [](GDALDatasetH d) {
                                                 GDALSetRasterScale(GDALGetRasterBand(d, 1), 0.1);
                                                 GDALSetRasterOffset(GDALGetRasterBand(d, 1), 100);
                                               }}));
  EXPECT_EQ(file.dem.z(0, 0), 101);
  EXPECT_EQ(file.dem.known(0, 1), 0);
  EXPECT_EQ(file.source.type, CellType::float32);  // int16 metres would lose the decimals
  EXPECT_THAT(file.source.metadata,
              Contains(testing::Pair("HEIGHTS", HasSubstr("file value * 0.1 + 100"))));
  write_dem(at("b.tif"), file.dem, file.source);
  EXPECT_EQ(read_dem(at("b.tif")).dem.z, file.dem.z);
}

TEST_F(Io, FeetBecomeMetres) {
  const auto in_feet = [](const char* unit) {
    return [unit](GDALDatasetH d) { GDALSetRasterUnitType(GDALGetRasterBand(d, 1), unit); };
  };
  const std::vector<double> cells{1000, 2000, 3000, 4000, 5000, 6000};
  const DemFile ft =
      read_dem(make("ft.tif", {.type = GDT_Int16, .cells = cells, .more = in_feet("ft")}));
  EXPECT_EQ(ft.dem.z(0, 0), 304.8f);
  EXPECT_THAT(ft.source.metadata, Contains(testing::Pair("HEIGHTS", HasSubstr("0.3048"))));
  const DemFile us = read_dem(make("us.tif", {.cells = cells, .more = in_feet("US survey foot")}));
  EXPECT_EQ(us.dem.z(2, 1), float(6000 * 1200.0 / 3937));
  write_dem(at("back.tif"), ft.dem, ft.source);
  EXPECT_EQ(read_dem(at("back.tif")).dem.z, ft.dem.z);  // not converted a second time
}

// --- No-data and its evidence
// -----------------------------------------------------------------------

auto sign(const std::string& what, std::uint64_t cells, bool used) {
  return AllOf(Field(&NodataEvidence::what, what), Field(&NodataEvidence::cells, cells),
               Field(&NodataEvidence::used, used), Field(&NodataEvidence::why, Not(IsEmpty())));
}

TEST_F(Io, DeclaredNodataIsUnknown) {
  const DemFile file = read_dem(make("a.tif", {.cells = {1, -5, 3, 4, -5, 6}, .nodata = -5}));
  EXPECT_EQ(count(file.dem.known), 4u);
  EXPECT_EQ(file.dem.z(1, 0), 0);
  EXPECT_EQ(file.source.nodata, -5);
  EXPECT_THAT(file.source.evidence, Contains(sign("declared value -5", 2, true)));
}

TEST_F(Io, LowestFloatMayBeDeclaredWithFewDigits) {
  const double lowest = -3.4028234663852886e38;
  const DemFile file =
      read_dem(make("a.tif", {.cells = {1, lowest, 3, 4, 5, 6}, .nodata = -3.40282e38}));
  EXPECT_EQ(count(file.dem.known), 5u);
}

TEST_F(Io, NanInfinityAndHugeValuesAreUnknown) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::string path = make("a.tif", {.cells = {kNaN, inf, -inf, 4, -3.4e38, 6}});
  for (const bool detect : {true, false}) {
    const DemFile file = read_dem(path, {.detect_nodata = detect});
    EXPECT_EQ(count(file.dem.known), 2u);
    for (float z : file.dem.z.cells()) EXPECT_TRUE(std::isfinite(z));
    EXPECT_THAT(file.source.evidence, Contains(sign("NaN", 1, true)));
    EXPECT_THAT(file.source.evidence, Contains(sign("infinity", 2, true)));
    EXPECT_THAT(file.source.evidence, Contains(sign("beyond 1e30", 1, true)));
  }
}

TEST_F(Io, NanDeclaredIsEvidenceOnce) {
  const DemFile file = read_dem(make("a.tif", {.cells = {kNaN, 2, 3, 4, 5, 6}, .nodata = kNaN}));
  EXPECT_THAT(file.source.evidence, ::testing::ElementsAre(sign("declared value nan", 1, true)));
}

TEST_F(Io, UndeclaredSentinelsCountOnlyWhenIsolated) {
  const std::string alone =
      make("a.tif", {.type = GDT_Int16, .cells = {-9999, 2, 3, 32767, 5, -32768}});
  const DemFile file = read_dem(alone);
  EXPECT_EQ(count(file.dem.known), 3u);
  EXPECT_THAT(file.source.evidence, Contains(sign("undeclared -9999", 1, true)));
  EXPECT_THAT(file.source.evidence, Contains(sign("undeclared 32767", 1, true)));
  EXPECT_THAT(file.source.evidence, Contains(sign("undeclared -32768", 1, true)));
  EXPECT_EQ(count(read_dem(alone, {.detect_nodata = false}).dem.known), 6u);

  // A trench: -9999 m is an ordinary depth there. 500 m is still near, 501 is not.
  const std::string trench = make("b.tif", {.cells = {-9999, 2, -9499, 4, 5, 6}});
  EXPECT_EQ(count(read_dem(trench).dem.known), 6u);
  EXPECT_THAT(read_dem(trench).source.evidence, Contains(sign("undeclared -9999", 1, false)));
  const std::string cliff = make("c.tif", {.cells = {-9999, 2, -9498, 4, 5, 6}});
  EXPECT_EQ(count(read_dem(cliff).dem.known), 5u);
}

TEST_F(Io, GivenNodataOverridesTheDeclaredOne) {
  const std::string path = make("a.tif", {.cells = {1, -5, 3, 4, 0, 6}, .nodata = -5});
  const DemFile file = read_dem(path, {.nodata = 0.0});
  EXPECT_EQ(count(file.dem.known), 5u);
  EXPECT_EQ(file.dem.z(1, 0), -5);
  EXPECT_THAT(file.source.evidence, Contains(sign("given value 0", 1, true)));
  EXPECT_THAT(file.source.evidence, Contains(sign("declared value -5", 0, false)));
}

TEST_F(Io, MaskBandAndAlphaAreUnknown) {
  const DemFile masked = read_dem(
      make("m.tif", {.cells = {1, 2, 3, 4, 5, 6}, .more = [](GDALDatasetH d) {
                       GDALCreateDatasetMaskBand(d, GMF_PER_DATASET);
                       std::uint8_t mask[6] = {255, 0, 255, 255, 0, 255};
                       EXPECT_EQ(GDALRasterIO(GDALGetMaskBand(GDALGetRasterBand(d, 1)), GF_Write, 0,
                                              0, 3, 2, mask, 3, 2, GDT_Byte, 0, 0),
                                 CE_None);
                     }}));
  EXPECT_EQ(count(masked.dem.known), 4u);
  EXPECT_EQ(masked.dem.known(1, 0), 0);
  EXPECT_EQ(masked.dem.known(1, 1), 0);
  EXPECT_THAT(masked.source.evidence, Contains(sign("mask band", 2, true)));

  const DemFile alpha = read_dem(make(
      "a.tif",
      {.type = GDT_UInt16, .bands = 2, .cells = {1, 2, 3, 4, 5, 6}, .more = [](GDALDatasetH d) {
         const GDALRasterBandH band = GDALGetRasterBand(d, 2);
         GDALSetRasterColorInterpretation(GDALGetRasterBand(d, 1), GCI_GrayIndex);
         GDALSetRasterColorInterpretation(band, GCI_AlphaBand);
         std::uint16_t mask[6] = {65535, 65535, 0, 65535, 65535, 65535};
         EXPECT_EQ(GDALRasterIO(band, GF_Write, 0, 0, 3, 2, mask, 3, 2, GDT_UInt16, 0, 0), CE_None);
       }}));
  EXPECT_EQ(count(alpha.dem.known), 5u);
  EXPECT_EQ(alpha.dem.known(2, 0), 0);
}

TEST_F(Io, SignedBytesKeepTheirSign) {
  Dem dem = small_dem();
  for (float& z : dem.z.cells()) z = z != 0 ? -z / 4 : 0;
  write_dem(at("a.tif"), dem, {}, {.type = CellType::int8});
  const DemFile file = read_dem(at("a.tif"));
  EXPECT_EQ(file.source.type, CellType::int8);
  EXPECT_EQ(file.dem.z(0, 0), -25);
  EXPECT_EQ(file.dem.known, dem.known);
}

// --- Through GDAL: writing
// ---------------------------------------------------------------------------

class WriteAs : public Io, public ::testing::WithParamInterface<CellType> {};

TEST_P(WriteAs, KeepsTypeMaskPlaceAndWords) {
  Dem dem = small_dem();
  for (float& z : dem.z.cells()) z = std::trunc(z);
  dem.ref.crs_wkt = utm_wkt();
  Source source;
  source.type = GetParam();
  source.band_description = "bare ground";
  source.metadata = {{"SURVEY", "1921"}};
  for (const std::string format : {"GTiff", "COG"}) {
    const std::string path = at(format + ".tif");
    write_dem(path, dem, source, {.format = format, .metadata = {{"FILLED", "yes"}}});
    const DemFile file = read_dem(path);
    EXPECT_TRUE(file.dem.z == dem.z) << format;
    EXPECT_EQ(file.dem.known, dem.known) << format;
    EXPECT_EQ(file.dem.ref, dem.ref) << format;
    EXPECT_EQ(file.source.type, GetParam()) << format;
    EXPECT_TRUE(file.source.nodata.has_value()) << format;
    EXPECT_EQ(file.source.band_description, "bare ground") << format;
    EXPECT_THAT(file.source.metadata,
                Contains(std::pair<std::string, std::string>("SURVEY", "1921")));
    EXPECT_THAT(file.source.metadata,
                Contains(std::pair<std::string, std::string>("FILLED", "yes")));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryType, WriteAs,
                         ::testing::Values(CellType::uint8, CellType::int16, CellType::uint16,
                                           CellType::int32, CellType::uint32, CellType::float32,
                                           CellType::float64));

TEST_F(Io, AsciiGridTakesItsSidecarsAlong) {
  Dem dem = small_dem();
  dem.ref.to_world[5] = -30;  // square cells, which every reader of this format understands
  dem.ref.crs_wkt = utm_wkt();
  write_dem(at("a.asc"), dem);
  EXPECT_THAT(files(), Contains("a.prj"));
  const DemFile file = read_dem(at("a.asc"));
  EXPECT_TRUE(file.dem.z == dem.z);
  EXPECT_EQ(file.dem.known, dem.known);
  EXPECT_EQ(file.dem.ref.to_world, dem.ref.to_world);
  EXPECT_TRUE(file.source.nodata.has_value());
  for (const std::string& name : files()) EXPECT_EQ(name.find('.'), 1u) << name;  // none hidden
}

TEST_F(Io, DoublesOfKnownCellsComeBackBitForBit) {
  const std::vector<double> cells{100.1, 200.2, 1e-3 + 1e-12, -9999, 1234567.891, 6};
  const DemFile file =
      read_dem(make("a.tif", {.type = GDT_Float64, .cells = cells, .nodata = -9999}));
  ASSERT_FALSE(file.source.exact.empty());
  Dem filled = file.dem;
  filled.known(0, 1) = 1;
  filled.z(0, 1) = 150.5f;
  write_dem(at("b.tif"), filled, file.source);
  const DemFile again = read_dem(at("b.tif"));
  EXPECT_EQ(again.source.type, CellType::float64);
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(again.source.exact(i % 3, i / 3)),
              std::bit_cast<std::uint64_t>(i == 3 ? 150.5 : cells[std::size_t(i)]));
}

TEST_F(Io, LargeIntegersComeBackExactly) {
  const DemFile file =
      read_dem(make("a.tif", {.type = GDT_Int32, .cells = {16777217, 2, 3, 4, 5, 6}}));
  write_dem(at("b.tif"), file.dem, file.source);
  const DemFile again = read_dem(at("b.tif"));
  EXPECT_EQ(again.source.type, CellType::int32);
  EXPECT_EQ(again.source.exact(0, 0), 16777217);
  EXPECT_TRUE(read_dem(make("c.tif", {.type = GDT_Int32, .cells = {1, 2, 3, 4, 5, 6}}))
                  .source.exact.empty());
}

TEST_F(Io, IntegersAreRoundedHalfAwayFromZero) {
  Dem dem;
  dem.z = Raster<float>({6, 1});
  dem.known = Mask({6, 1}, 1);
  const float from[] = {0.5f, -0.5f, 1.5f, -2.5f, 0.49999997f, -7.4f};
  const float to[] = {1, -1, 2, -3, 0, -7};
  std::copy(from, from + 6, dem.z.cells().begin());
  write_dem(at("a.tif"), dem, {}, {.type = CellType::int16});
  const DemFile file = read_dem(at("a.tif"));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(file.dem.z(i, 0), to[i]) << from[i];
}

TEST_F(Io, ValuesOutsideTheTypeAreRefusedNotWrapped) {
  Dem dem = small_dem();
  dem.z(0, 0) = 300;
  EXPECT_THAT(io_error([&] { write_dem(at("a.tif"), dem, {}, {.type = CellType::uint8}); }),
              HasSubstr("elevation 300 does not fit the type, 0 to 255"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Io, NodataNeverMeetsAnElevation) {
  Dem dem = small_dem();
  Source source;
  source.nodata = 0;
  dem.z(0, 0) = 0;  // an elevation that is the source's no-data value
  write_dem(at("a.tif"), dem, source);
  const DemFile file = read_dem(at("a.tif"));
  EXPECT_EQ(file.dem.known, dem.known);
  EXPECT_EQ(file.source.nodata, -9999);
  EXPECT_THAT(io_error([&] { write_dem(at("b.tif"), dem, source, {.nodata = 0.0}); }),
              HasSubstr("nodata 0 is also an elevation"));
  EXPECT_THAT(io_error([&] {
                write_dem(at("b.tif"), dem, source, {.type = CellType::uint8, .nodata = -1.0});
              }),
              HasSubstr("nodata -1 does not fit"));
}

TEST_F(Io, GeoTiffIsTiledAndDeflated) {
  write_dem(at("a.tif"), large_dem());
  const GDALDatasetH d = GDALOpen(at("a.tif").c_str(), GA_ReadOnly);
  EXPECT_STREQ(GDALGetMetadataItem(d, "COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_STREQ(GDALGetMetadataItem(d, "PREDICTOR", "IMAGE_STRUCTURE"), "3");
  int width = 0, height = 0;
  GDALGetBlockSize(GDALGetRasterBand(d, 1), &width, &height);
  EXPECT_EQ(width, 256);
  GDALClose(d);
}

TEST_F(Io, ThreadsDoNotChangeTheFile) {
  write_dem(at("1.tif"), large_dem(), {}, {}, {.threads = 1, .progress = {}});
  write_dem(at("3.tif"), large_dem(), {}, {}, {.threads = 3, .progress = {}});
  EXPECT_TRUE(bytes_of(at("1.tif")) == bytes_of(at("3.tif")));
}

TEST_F(Io, FormatsThatCannotBeAreRefused) {
  const auto error = [&](const std::string& name, const std::string& format = "") {
    const std::string message =
        io_error([&] { write_dem(at(name), small_dem(), {}, {.format = format}); });
    EXPECT_THAT(files(), IsEmpty());
    return message;
  };
  EXPECT_THAT(error("a.mem", "MEM"), HasSubstr("MEM dataset is no file"));
  EXPECT_THAT(error("a"), HasSubstr("names no format"));
  EXPECT_THAT(error("a.nothing"), HasSubstr("names no format"));
  EXPECT_THAT(error("a.tif", "Nonsense"), HasSubstr("there is no format \"Nonsense\""));
  EXPECT_THAT(error("a.png", "PNG"), HasSubstr("PNG"));  // GDAL's PNG holds no floats
}

TEST_F(Io, ReadsThroughVirtualFileSystems) {
  write_dem(at("a.tif"), small_dem());
  const std::string inside = "/vsizip/" + at("a.zip") + "/deep/a.tif";
  VSILFILE* f = VSIFOpenL(inside.c_str(), "wb");
  const std::string bytes = bytes_of(at("a.tif"));
  VSIFWriteL(bytes.data(), 1, bytes.size(), f);
  VSIFCloseL(f);
  EXPECT_EQ(read_dem(inside).dem.known, small_dem().known);
  EXPECT_THAT(io_error([&] { write_dem("/vsimem/a.tif", small_dem()); }), HasSubstr("plain files"));
}

// --- Whole or not at all
// -------------------------------------------------------------------------------

TEST_F(Io, ExistingFilesAreRefusedUnlessAsked) {
  put(at("a.tif"), "mine");
  EXPECT_THAT(io_error([&] { write_dem(at("a.tif"), small_dem()); }),
              HasSubstr("exists, and overwriting it was not asked for"));
  EXPECT_THAT(io_error([&] { check_writable(at("a.tif"), false); }), HasSubstr("exists"));
  EXPECT_EQ(bytes_of(at("a.tif")), "mine");
  check_writable(at("a.tif"), true);
  EXPECT_EQ(bytes_of(at("a.tif")), "mine");
  write_dem(at("a.tif"), small_dem(), {}, {.overwrite = true});
  EXPECT_EQ(read_dem(at("a.tif")).dem.known, small_dem().known);
  EXPECT_THAT(files(), ::testing::ElementsAre("a.tif"));
}

TEST_F(Io, TheFileReadMayBeTheFileWritten) {
  write_dem(at("a.tif"), small_dem());
  DemFile file = read_dem(at("a.tif"));
  file.dem.z(0, 0) = 7;
  write_dem(at("a.tif"), file.dem, file.source, {.overwrite = true});
  EXPECT_EQ(read_dem(at("a.tif")).dem.z(0, 0), 7);
}

TEST_F(Io, SymbolicLinksSurvive) {
  put(at("real.tif"), "old");
  fs::create_symlink("real.tif", at("link.tif"));
  write_dem(at("link.tif"), small_dem(), {}, {.overwrite = true});
  EXPECT_TRUE(fs::is_symlink(at("link.tif")));
  EXPECT_EQ(read_dem(at("real.tif")).dem.known, small_dem().known);
}

TEST_F(Io, StaleSidecarsDoNotOutliveTheFile) {
  write_dem(at("a.tif"), small_dem());
  put(at("a.tif.aux.xml"),
      "<PAMDataset><Metadata><MDI key=\"OLD\">1</MDI></Metadata></PAMDataset>");
  write_dem(at("a.tif"), small_dem(), {}, {.overwrite = true});
  EXPECT_THAT(files(), ::testing::ElementsAre("a.tif"));
}

TEST_F(Io, SomeoneElsesSidecarIsNotReplaced) {
  put(at("a.prj"), "of a shapefile");
  Dem dem = small_dem();
  dem.ref.crs_wkt = utm_wkt();
  EXPECT_THAT(io_error([&] { write_dem(at("a.asc"), dem); }), HasSubstr("a.prj: exists"));
  EXPECT_EQ(bytes_of(at("a.prj")), "of a shapefile");
  EXPECT_THAT(files(), ::testing::ElementsAre("a.prj"));
}

TEST_F(Io, PlacesThatTakeNoFileAreToldBeforehand) {
  EXPECT_THAT(io_error([&] { check_writable(at("none/a.tif"), false); }),
              HasSubstr("does not exist"));
  EXPECT_THAT(io_error([&] { write_dem(at("none/a.tif"), small_dem()); }),
              HasSubstr("does not exist"));
  EXPECT_THAT(io_error([&] { check_writable(folder_.string(), true); }), HasSubstr("is a folder"));
  EXPECT_THAT(io_error([&] { check_writable("/dev/null", true); }),
              HasSubstr("not a regular file"));
  EXPECT_THAT(io_error([&] { check_writable("/proc/a.tif", false); }),
              HasSubstr("cannot be written"));
  check_writable(at("fine.tif"), false);
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Io, CancelledWritingLeavesWhatWasThere) {
  put(at("old.tif"), "mine");
  put(at("N36E008.hgt"), hgt_bytes(1201));
  const DemFile tile = read_dem(at("N36E008.hgt"));
  dem::Run run;
  run.progress = [](double part, std::string_view) { return part < 0.3; };
  EXPECT_THROW(write_dem(at("old.tif"), large_dem(), {}, {.overwrite = true}, run), Cancelled);
  EXPECT_THROW(write_dem(at("cog.tif"), large_dem(), {}, {.format = "COG"}, run), Cancelled);
  EXPECT_THROW(write_dem(at("a.asc"), large_dem(), {}, {}, run), Cancelled);
  EXPECT_THROW(write_dem(at("a.png"), large_dem(), {}, {}, run), Cancelled);
  EXPECT_THROW(write_dem(at("new.hgt"), tile.dem, tile.source, {}, run), Cancelled);
  EXPECT_EQ(bytes_of(at("old.tif")), "mine");
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(Io, CancelledReadingThrows) {
  write_dem(at("a.tif"), large_dem());
  write_dem(at("a.png"), large_dem());
  put(at("N36E008.hgt"), hgt_bytes(1201));
  dem::Run run;
  run.progress = [](double part, std::string_view) { return part < 0.3; };
  EXPECT_THROW(read_dem(at("a.tif"), {}, run), Cancelled);
  EXPECT_THROW(read_dem(at("a.png"), {}, run), Cancelled);
  EXPECT_THROW(read_dem(at("N36E008.hgt"), {}, run), Cancelled);
}

TEST_F(Io, FullDiskIsOneErrorAndLeavesWhatWasThere) {
  put(at("N36E008.hgt"), hgt_bytes(1201));
  const DemFile tile = read_dem(at("N36E008.hgt"));
  const Dem large = large_dem();
  std::vector<std::pair<std::string, std::string>> outputs;
  outputs = {{"a.tif", ""}, {"cog.tif", "COG"}, {"a.asc", ""},         {"a.png", ""},
             {"a.exr", ""}, {"raw.bil", ""},    {"N36E008.hgt", "HGT"}};
  for (const auto& output : outputs) {
    const std::string name = output.first, format = output.second;
    const bool hgt = format == "HGT";
    const std::string path = at(name), before = bytes_of(path);
    // A file system that takes files up to 100 kB, in a process of its own.
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{100000, 100000};
      setrlimit(RLIMIT_FSIZE, &limit);
      const std::string error = io_error([&] {
        write_dem(path, hgt ? tile.dem : large, hgt ? tile.source : Source{},
                  {.format = format, .overwrite = true}, {.threads = 1, .progress = {}});
      });
      const bool good = error.starts_with(path + ": ") && error.size() > path.size() + 5;
      if (!good) write(2, error.data(), error.size());
      _exit(good ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << name;
    EXPECT_TRUE(bytes_of(path) == before) << name;
    EXPECT_THAT(files(), ::testing::ElementsAre("N36E008.hgt")) << name;
  }
}

TEST_F(Io, TextIsWrittenWholeOrRefused) {
  write_text(at("a.txt"), "one\n", false);
  EXPECT_EQ(bytes_of(at("a.txt")), "one\n");
  EXPECT_THAT(io_error([&] { write_text(at("a.txt"), "two\n", false); }), HasSubstr("exists"));
  write_text(at("a.txt"), "two\n", true);
  EXPECT_EQ(bytes_of(at("a.txt")), "two\n");
  EXPECT_THAT(files(), ::testing::ElementsAre("a.txt"));
}

// --- Heightmap images
// --------------------------------------------------------------------------------

TEST_F(Io, ImagesHoldHeightsToWithinHalfAGrey) {
  const Dem dem = small_dem();
  const double step = (dem.z(3, 0) - dem.z(0, 2)) / 65535;
  for (const std::string name : {"a.png", "b.tif"}) {
    write_dem(at(name), dem, {}, {.format = "image"});
    ReadOptions options;
    if (name == "b.tif") options.heights = HeightRange{dem.z(0, 2), dem.z(3, 0)};
    const DemFile file = read_dem(at(name), options);
    EXPECT_EQ(file.source.format, "image") << name;
    EXPECT_EQ(file.source.type, CellType::uint16) << name;
    EXPECT_EQ(file.dem.known, dem.known) << name;  // by alpha
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_NEAR(file.dem.z.cells()[i], dem.z.cells()[i], step / 2 + 1e-5) << name;  // + float32
  }
}

TEST_F(Io, ImagesSayTheirRangeThemselves) {
  write_dem(at("a.png"), small_dem(), {}, {.heights = HeightRange{-100, 900}});
  const DemFile file = read_dem(at("a.png"));
  EXPECT_NEAR(file.dem.z(0, 0), 100, 1000.0 / 65535);
  EXPECT_NEAR(read_dem(at("a.png"), {.heights = HeightRange{0, 2000}}).dem.z(0, 0), 400, 0.05);
  EXPECT_THAT(io_error([&] {
                write_dem(at("b.png"), small_dem(), {}, {.heights = HeightRange{0, 50}});
              }),
              HasSubstr("leave the range"));
}

TEST_F(Io, AGreyMayMeanUnknownAndNoKnownCellGetsIt) {
  Dem dem = small_dem();
  dem.z(0, 0) = 0;  // the lowest: would be black, which is to mean unknown
  write_dem(at("a.png"), dem, {}, {.heights = HeightRange{0, 200}, .unknown_grey = 0.0});
  const DemFile file = read_dem(at("a.png"), {.unknown_grey = 0.0});
  EXPECT_EQ(file.dem.known, dem.known);
  EXPECT_THAT(file.source.evidence, Contains(sign("grey 0", 1, true)));
  EXPECT_NEAR(file.dem.z(0, 0), 0, 200.0 / 65535 + 1e-6);
}

TEST_F(Io, ExrHoldsMetresExactly) {
  const Dem dem = small_dem();
  write_dem(at("a.exr"), dem);
  const DemFile file = read_dem(at("a.exr"));
  EXPECT_TRUE(file.dem.z == dem.z);
  EXPECT_EQ(file.dem.known, dem.known);
  EXPECT_EQ(file.source.type, CellType::float32);
}

TEST_F(Io, EightBitHeightmapsKeepTheirGreys) {
  make("a.png",
       {.format = "PNG", .type = GDT_Byte, .cells = {0, 10, 20, 30, 128, 255}, .transform = {}});
  fs::remove(at("a.png.aux.xml"));
  const DemFile file = read_dem(at("a.png"));
  EXPECT_EQ(file.source.type, CellType::uint8);
  EXPECT_EQ(file.dem.z(1, 0), 10);  // without a range, a grey level is a metre
  write_dem(at("b.png"), file.dem, file.source);
  EXPECT_EQ(read_dem(at("b.png")).dem.z, file.dem.z);
}

TEST_F(Io, ColourImagesNeedAChoiceOfBand) {
  make("a.png", {.format = "PNG", .type = GDT_Byte, .bands = 3, .transform = {}});
  EXPECT_THAT(io_error([&] { read_dem(at("a.png")); }),
              HasSubstr("has 3 bands; one must be chosen"));
  EXPECT_EQ(read_dem(at("a.png"), {.band = 2}).dem.size(), (Size{3, 2}));
}

TEST_F(Io, JpegHasNoAlpha) {
  EXPECT_THAT(io_error([&] { write_dem(at("a.jpg"), small_dem()); }), HasSubstr("unknown_grey"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Io, OptionsThatHaveNoMeaningAreRefused) {
  put(at("N36E008.hgt"), hgt_bytes(3));
  write_dem(at("a.tif"), small_dem());
  EXPECT_THAT(io_error([&] { read_dem(at("a.tif"), {.tile = "N36E008"}); }),
              HasSubstr("tile N36E008"));
  EXPECT_THAT(io_error([&] { read_dem(at("N36E008.hgt"), {.heights = HeightRange{}}); }),
              HasSubstr("grey"));
  EXPECT_THAT(io_error([&] { write_dem(at("a.png"), small_dem(), {}, {.nodata = 0.0}); }),
              HasSubstr("nodata"));
}

}  // namespace
}  // namespace dem
