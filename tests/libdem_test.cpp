#include "libdem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "dem/io/methods.h"
#include "dem/io/rasters.h"
#include "dem/spline.h"

namespace {

constexpr int kCols = 31, kRows = 23;

using Dem = std::unique_ptr<libdem_dem, decltype(&libdem_free)>;
using Method = std::unique_ptr<libdem_method, decltype(&libdem_free_method)>;

/// A hill with waves; NaN in a hole.
std::vector<float> hill_with_hole() {
  std::vector<float> z;
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col) {
      const bool hole = col > 8 && col < 20 && row > 6 && row < 15;
      z.push_back(hole ? NAN : 300 + 40 * std::sin(float(col) / 5) + 3 * float(row));
    }
  return z;
}

Dem made(const std::vector<float>& z, double dx = 70, double dy = 90) {
  libdem_dem* dem = nullptr;
  libdem_error error;
  EXPECT_EQ(libdem_create(z.data(), nullptr, kCols, kRows, dx, dy, &dem, &error), LIBDEM_OK);
  EXPECT_STREQ(error.text, "");
  return {dem, libdem_free};
}

Method chosen(const char* name) {
  libdem_method* method = nullptr;
  EXPECT_EQ(libdem_choose(name, &method, nullptr), LIBDEM_OK);
  return {method, libdem_free_method};
}

Dem filled(const Dem& holes, const Method& method) {
  libdem_dem* dem = nullptr;
  libdem_error error;
  EXPECT_EQ(libdem_fill(holes.get(), method.get(), nullptr, nullptr, &dem, &error), LIBDEM_OK)
      << error.text;
  return {dem, libdem_free};
}

std::vector<float> heights(const Dem& dem) {
  const float* z = libdem_heights(dem.get());
  return {z, z + kCols * kRows};
}

/// The call was refused, nothing came out, and the text says each of `says`.
void expect_refused(libdem_status got, libdem_status expected, const void* out,
                    const libdem_error& error, const std::vector<std::string>& says) {
  EXPECT_EQ(got, expected);
  EXPECT_EQ(out, nullptr);
  for (const auto& words : says)
    EXPECT_NE(std::string(error.text).find(words), std::string::npos) << error.text;
}

TEST(LibdemC, FillsAsTheMethodDoesBitForBit) {
  const auto z = hill_with_hole();
  dem::Dem same{dem::Raster<float>({kCols, kRows}), dem::Mask({kCols, kRows}), {}, {70, 90}};
  for (std::size_t i = 0; i < z.size(); ++i)
    if (std::isfinite(z[i])) same.z.cells()[i] = z[i], same.known.cells()[i] = 1;
  const dem::Filled expected = dem::fill_spline(same, {.sigma = dem::SplineSigma::law});

  const Method method = chosen("spline");
  ASSERT_EQ(libdem_set(method.get(), "sigma", "law", nullptr), LIBDEM_OK);
  const Dem out = filled(made(z), method);
  EXPECT_EQ(heights(out), std::vector(expected.z.cells().begin(), expected.z.cells().end()));
  ASSERT_NE(libdem_sigma(out.get()), nullptr);
  EXPECT_TRUE(std::equal(expected.sigma.cells().begin(), expected.sigma.cells().end(),
                         libdem_sigma(out.get())));
}

TEST(LibdemC, NoMethodIsTheDefaultOne) {
  const Dem holes = made(hill_with_hole());
  const Dem by_default = filled(holes, {nullptr, libdem_free_method});
  EXPECT_EQ(heights(by_default),
            heights(filled(holes, chosen(std::string(dem::default_fill_method()).c_str()))));
  EXPECT_EQ(libdem_sigma(by_default.get()), nullptr);
}

TEST(LibdemC, MaskDecidesWhereItIsGiven) {
  auto z = hill_with_hole();
  std::vector<std::uint8_t> known(z.size(), 1);
  for (std::size_t i = 0; i < z.size(); ++i)
    if (std::isnan(z[i])) known[i] = 0, z[i] = -32768;
  libdem_dem* dem = nullptr;
  ASSERT_EQ(libdem_create(z.data(), known.data(), kCols, kRows, 70, 90, &dem, nullptr), LIBDEM_OK);
  const Dem masked(dem, libdem_free);
  EXPECT_EQ(heights(filled(masked, chosen("mcmd"))),
            heights(filled(made(hill_with_hole()), chosen("mcmd"))));
}

TEST(LibdemC, TellsWhatItHolds) {
  const Dem dem = made(hill_with_hole());
  EXPECT_EQ(libdem_cols(dem.get()), kCols);
  EXPECT_EQ(libdem_rows(dem.get()), kRows);
  EXPECT_EQ(libdem_dx_m(dem.get()), 70);
  EXPECT_EQ(libdem_dy_m(dem.get()), 90);
  EXPECT_EQ(libdem_known(dem.get())[0], 1);
  EXPECT_EQ(libdem_known(dem.get())[7 * kCols + 9], 0);
}

TEST(LibdemC, MethodsAndSettingsAreThoseOfTheTable) {
  const auto& table = dem::all_fill_methods();
  ASSERT_EQ(libdem_method_count(), table.size());
  EXPECT_EQ(libdem_method_name(table.size()), nullptr);
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(libdem_method_name(i), table[i].name);
    EXPECT_EQ(libdem_method_summary(i), table[i].summary);
    const Method method = chosen(libdem_method_name(i));
    ASSERT_EQ(libdem_setting_count(method.get()), table[i].fields.size());
    for (std::size_t k = 0; k < table[i].fields.size(); ++k) {
      libdem_setting setting;
      ASSERT_EQ(libdem_setting_at(method.get(), k, &setting, nullptr), LIBDEM_OK);
      EXPECT_EQ(setting.name, table[i].fields[k].name);
      EXPECT_EQ(setting.default_value, table[i].fields[k].default_text);
      EXPECT_EQ(libdem_set(method.get(), setting.name, setting.default_value, nullptr), LIBDEM_OK);
    }
  }
}

TEST(LibdemC, RefusedSettingChangesNothing) {
  const Method method = chosen("mcmd");
  ASSERT_EQ(libdem_set(method.get(), "weight_exponent", "2", nullptr), LIBDEM_OK);
  const Dem holes = made(hill_with_hole());
  const auto before = heights(filled(holes, method));
  libdem_error error;
  expect_refused(libdem_set(method.get(), "weight_exponent", "many", &error), LIBDEM_INVALID,
                 nullptr, error, {"weight_exponent = many", "must be"});
  expect_refused(libdem_set(method.get(), "colour", "1", &error), LIBDEM_INVALID, nullptr, error,
                 {"colour", "weight_exponent"});
  EXPECT_EQ(heights(filled(holes, method)), before);
}

TEST(LibdemC, WrongArgumentsAreNamed) {
  const auto z = hill_with_hole();
  libdem_dem* dem = nullptr;
  libdem_error error;
  const auto create = [&](const float* heights, int cols, double dx) {
    return libdem_create(heights, nullptr, cols, kRows, dx, 90, &dem, &error);
  };
  expect_refused(create(nullptr, kCols, 70), LIBDEM_INVALID, dem, error, {"heights = NULL"});
  expect_refused(create(z.data(), 0, 70), LIBDEM_INVALID, dem, error, {"cols = 0"});
  expect_refused(create(z.data(), -5, 70), LIBDEM_INVALID, dem, error, {"cols = -5"});
  expect_refused(create(z.data(), kCols, 0), LIBDEM_INVALID, dem, error, {"dx_m = 0"});
  expect_refused(create(z.data(), kCols, NAN), LIBDEM_INVALID, dem, error, {"dx_m = nan"});
  EXPECT_EQ(libdem_create(z.data(), nullptr, kCols, kRows, 70, 90, nullptr, &error),
            LIBDEM_INVALID);
  const std::vector<std::uint8_t> known(z.size(), 1);
  expect_refused(libdem_create(z.data(), known.data(), kCols, kRows, 70, 90, &dem, &error),
                 LIBDEM_INVALID, dem, error, {"heights[226] = nan"});

  libdem_method* method = nullptr;
  expect_refused(libdem_choose("magic", &method, &error), LIBDEM_INVALID, method, error,
                 {"magic", "mcmd"});
  expect_refused(libdem_fill(nullptr, nullptr, nullptr, nullptr, &dem, &error), LIBDEM_INVALID, dem,
                 error, {"dem = NULL"});
  expect_refused(libdem_write_sigma(made(z).get(), "x.tif", 0, &error), LIBDEM_INVALID, nullptr,
                 error, {"sigma"});
}

TEST(LibdemC, NothingKnownCannotBeFilled) {
  const Dem empty = made(std::vector<float>(kCols * kRows, NAN));
  libdem_dem* out = nullptr;
  libdem_error error;
  expect_refused(libdem_fill(empty.get(), nullptr, nullptr, nullptr, &out, &error), LIBDEM_INVALID,
                 out, error, {"known"});
}

TEST(LibdemC, ErrorsOfFilesNameThePath) {
  libdem_dem* dem = nullptr;
  libdem_error error;
  expect_refused(libdem_read("nowhere.tif", &dem, &error), LIBDEM_FILE, dem, error,
                 {"nowhere.tif"});
  const std::string longer = std::string(2000, 'x') + ".tif";
  EXPECT_EQ(libdem_read(longer.c_str(), &dem, &error), LIBDEM_FILE);
  EXPECT_EQ(std::string(error.text).size(), sizeof error.text - 1);
}

TEST(LibdemC, ProgressStops) {
  int calls = 0;
  libdem_run run{
      1, [](double, const char*, void* user) { return int(++*static_cast<int*>(user) < 2); },
      &calls};
  libdem_dem* out = nullptr;
  libdem_error error;
  const Dem holes = made(hill_with_hole());
  expect_refused(libdem_fill(holes.get(), nullptr, nullptr, &run, &out, &error), LIBDEM_CANCELLED,
                 out, error, {"cancelled"});
  EXPECT_EQ(calls, 2);
}

class LibdemCFiles : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

 private:
  std::filesystem::path folder_ = testing::TempDir() + "/libdem_c";
};

TEST_F(LibdemCFiles, KeepTypeAndPlaceOfTheirSource) {
  dem::DemFile file = dem::read_dem(DEM_TESTDATA_DIR "/jacksboro.tif");
  file.dem.known(100, 100) = 0;
  dem::write_dem(path("holes.tif"), file.dem, file.source);

  libdem_dem* read = nullptr;
  ASSERT_EQ(libdem_read(path("holes.tif").c_str(), &read, nullptr), LIBDEM_OK);
  const Dem holes(read, libdem_free);
  const Method method = chosen("spline");
  ASSERT_EQ(libdem_set(method.get(), "sigma", "law", nullptr), LIBDEM_OK);
  const Dem out = filled(holes, method);
  libdem_error error;
  ASSERT_EQ(libdem_write(out.get(), path("out.tif").c_str(), 0, &error), LIBDEM_OK) << error.text;
  ASSERT_EQ(libdem_write_sigma(out.get(), path("sigma.tif").c_str(), 0, &error), LIBDEM_OK)
      << error.text;

  const dem::DemFile got = dem::read_dem(path("out.tif"));
  EXPECT_EQ(got.source.type, dem::CellType::int16);
  EXPECT_EQ(got.dem.ref, file.dem.ref);
  EXPECT_EQ(dem::count(got.dem.known), got.dem.size().cells());
  EXPECT_EQ(got.dem.z(0, 0), file.dem.z(0, 0));
  EXPECT_GT(dem::read_dem(path("sigma.tif")).dem.z(100, 100), 0);

  EXPECT_EQ(libdem_write(out.get(), path("out.tif").c_str(), 0, &error), LIBDEM_FILE);
  EXPECT_NE(std::string(error.text).find("exists"), std::string::npos) << error.text;
  EXPECT_EQ(libdem_write(out.get(), path("out.tif").c_str(), 1, &error), LIBDEM_OK);
}

TEST(LibdemC, EvaluatesTheFilledCellsAlone) {
  auto z = hill_with_hole();
  const Dem holes = made(z);
  const Dem got = filled(holes, chosen("spline"));
  auto moved = heights(got);
  for (std::size_t i = 0; i < z.size(); ++i) moved[i] += std::isfinite(z[i]) ? 0.0F : 3.0F;
  const Dem truth = made(moved);
  libdem_errors errors;
  libdem_error error;
  ASSERT_EQ(libdem_evaluate(truth.get(), got.get(), holes.get(), &errors, &error), LIBDEM_OK)
      << error.text;
  EXPECT_EQ(errors.cells,
            std::size_t(std::ranges::count_if(z, [](float v) { return !std::isfinite(v); })));
  EXPECT_NEAR(errors.bias_m, -3, 1e-4);
  EXPECT_NEAR(errors.max_m, 3, 1e-3);
  EXPECT_EQ(libdem_evaluate(truth.get(), got.get(), truth.get(), &errors, &error), LIBDEM_INVALID);
  EXPECT_NE(std::string(error.text).find("sampled"), std::string::npos) << error.text;
}

}  // namespace
