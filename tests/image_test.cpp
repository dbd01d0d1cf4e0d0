#include "dem/io/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "dem/io/rasters.h"

namespace dem {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Image : public ::testing::Test {
 protected:
  Image() {
    std::string name = (fs::temp_directory_path() / "dem_image_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Image() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  fs::path folder_;
};

TEST_F(Image, GreyPicturesComeBack) {
  Raster<std::uint8_t> grey({5, 3});
  for (std::size_t i = 0; i < 15; ++i) grey.cells()[i] = std::uint8_t(17 * i);
  write_image(at("a.png"), grey);
  const DemFile file = read_dem(at("a.png"));
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(file.dem.z.cells()[i], float(17 * i));
}

TEST_F(Image, ColourPicturesKeepTheirChannels) {
  Raster<Rgb> picture({2, 2});
  picture(1, 0) = {10, 20, 30};
  write_image(at("a.png"), picture);
  for (int band = 1; band <= 3; ++band)
    EXPECT_EQ(read_dem(at("a.png"), {.band = band}).dem.z(1, 0), float(10 * band));
}

TEST_F(Image, EncodedPicturesAreThoseOfFiles) {
  Raster<Rgb> picture({9, 4});
  picture(3, 2) = {10, 200, 30};
  Raster<std::uint8_t> grey({9, 4});
  grey(3, 2) = 99;
  const auto file = [&](const std::string& name) {
    std::ifstream in(at(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (const char* format : {"png", "jpg"}) {
    const std::string name = std::string("a.") + format;
    write_image(at(name), picture);
    EXPECT_EQ(encode_image(picture, format), file(name)) << format;
    write_image(at(name), grey);
    EXPECT_EQ(encode_image(grey, format), file(name)) << format;
  }
  EXPECT_THROW(encode_image(grey, "tif"), std::invalid_argument);
  EXPECT_THROW(encode_image(Raster<Rgb>(), "png"), std::invalid_argument);
}

TEST_F(Image, FailuresLeaveNothing) {
  const Raster<Rgb> picture({2, 2});
  const auto message = [&](const std::string& name, bool overwrite) -> std::string {
    try {
      write_image(at(name), picture, overwrite);
    } catch (const IoError& error) {
      return error.what();
    }
    return "no IoError";
  };
  EXPECT_THAT(message("a.unknown", false), HasSubstr("a.unknown: "));
  EXPECT_THAT(message("none/a.png", false), HasSubstr("does not exist"));
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(message("a.png", false), "no IoError");
  EXPECT_THAT(message("a.png", false), HasSubstr("exists"));
  EXPECT_THROW(write_image(at("b.png"), Raster<Rgb>()), IoError);
}

}  // namespace
}  // namespace dem
