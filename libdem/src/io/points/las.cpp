// LAS 1.0 to 1.4, uncompressed point records: x, y, z and the class.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/points/point_reading.h"

static_assert(std::endian::native == std::endian::little, "LAS is little-endian, read as it is");

namespace dem::io {
namespace {

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};
using File = std::unique_ptr<VSILFILE, CloseFile>;

/// The value of type T at a byte of a record.
template <class T>
T at(const std::vector<unsigned char>& bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::vector<unsigned char> read_bytes(VSILFILE* file, const std::string& path, vsi_l_offset offset,
                                      std::size_t n) {
  std::vector<unsigned char> bytes(n);
  if (VSIFSeekL(file, offset, SEEK_SET) != 0 || VSIFReadL(bytes.data(), 1, n, file) != n)
    throw IoError(path, fmt::format("LAS file is cut short: byte {} is missing", offset + n));
  return bytes;
}

struct Header {
  int minor = 0, format = 0;
  std::size_t header_bytes = 0, record_bytes = 0;
  std::uint64_t first_record = 0, points = 0;
  std::uint32_t variable_records = 0;
  std::array<double, 3> scale{}, offset{};
};

/// Fewest bytes of a record of each point format.
constexpr std::array<std::size_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

Header read_header(VSILFILE* file, const std::string& path) {
  constexpr std::size_t kShort = 227, kLong = 375;  // bytes: before 1.3, from 1.4
  const auto bytes = read_bytes(file, path, 0, kShort);
  Header h;
  const int major = bytes[24];
  h.minor = bytes[25];
  if (major != 1 || h.minor > 4)
    throw IoError(path, fmt::format("LAS {}.{}; must be 1.0 to 1.4", major, h.minor));
  h.header_bytes = at<std::uint16_t>(bytes, 94);
  h.first_record = at<std::uint32_t>(bytes, 96);
  h.variable_records = at<std::uint32_t>(bytes, 100);
  if (bytes[104] & 0xc0)
    throw IoError(path, "is compressed LAS; uncompress it first (laszip -i in.laz -o out.las)");
  h.format = bytes[104];
  h.record_bytes = at<std::uint16_t>(bytes, 105);
  h.points = at<std::uint32_t>(bytes, 107);
  for (std::size_t i = 0; i < 3; ++i) {
    h.scale[i] = at<double>(bytes, 131 + 8 * i);
    h.offset[i] = at<double>(bytes, 155 + 8 * i);
  }
  if (h.minor >= 4 && h.header_bytes >= kLong) {
    const auto more = read_bytes(file, path, 0, kLong);
    h.points = std::max<std::uint64_t>(h.points, at<std::uint64_t>(more, 247));
  }
  if (std::size_t(h.format) >= kRecordBytes.size())
    throw IoError(path, fmt::format("LAS point format {}; must be 0 to 10", h.format));
  if (h.record_bytes < kRecordBytes[std::size_t(h.format)])
    throw IoError(path, fmt::format("LAS records of {} bytes; point format {} has at least {}",
                                    h.record_bytes, h.format, kRecordBytes[std::size_t(h.format)]));
  for (const double s : h.scale)
    if (!(std::abs(s) > 0) || !std::isfinite(s))
      throw IoError(path, fmt::format("LAS scale factor {}; must not be 0", s));
  return h;
}

/// The coordinate system of the variable length records: WKT, or an EPSG code among GeoTIFF keys.
std::string read_crs(VSILFILE* file, const std::string& path, const Header& h) {
  constexpr std::size_t kVlrHeader = 54;
  constexpr int kWkt = 2112, kGeoKeys = 34735, kGeographic = 2048, kProjected = 3072;
  constexpr int kUserDefined = 32767;
  vsi_l_offset offset = h.header_bytes;
  int geographic = 0, projected = 0;
  for (std::uint32_t i = 0; i < h.variable_records && offset + kVlrHeader <= h.first_record; ++i) {
    const auto head = read_bytes(file, path, offset, kVlrHeader);
    const int id = at<std::uint16_t>(head, 18);
    const std::size_t length = at<std::uint16_t>(head, 20);
    offset += kVlrHeader;
    if (id == kWkt) {
      const auto text = read_bytes(file, path, offset, length);
      const std::string wkt(text.begin(), std::ranges::find(text, 0));
      if (!wkt.empty()) return wkt;
    } else if (id == kGeoKeys) {
      const auto keys = read_bytes(file, path, offset, length);
      for (std::size_t k = 8; k + 8 <= keys.size(); k += 8) {
        const int key = at<std::uint16_t>(keys, k), value = at<std::uint16_t>(keys, k + 6);
        if (key == kGeographic && value != kUserDefined) geographic = value;
        if (key == kProjected && value != kUserDefined) projected = value;
      }
    }
    offset += length;
  }
  const int code = projected != 0 ? projected : geographic;
  return code == 0 ? "" : fmt::format("EPSG:{}", code);
}

/// Whether the record is one that was asked for.
bool is_wanted(const unsigned char* record, int format, const std::vector<int>& classes) {
  const bool is_new = format >= 6;
  const bool withheld = is_new ? (record[15] & 4) != 0 : (record[15] & 128) != 0;
  const int classification = is_new ? record[16] : record[15] & 31;
  return !withheld && (classes.empty() || std::ranges::count(classes, classification) > 0);
}

}  // namespace

void read_las_points(const std::string& path, const PointReadOptions& options, PointSource& source,
                     const PointParts& parts, const Run& run) {
  for (const auto* field : {&options.x_field, &options.y_field, &options.z_field,
                            &options.sigma_field, &options.weight_field, &options.position_field})
    if (!field->empty())
      throw IoError(path, "is LAS, whose points have no named columns; " + *field + " is none");
  const GdalErrors errors;
  const File file(VSIFOpenL(path.c_str(), "rb"));
  if (!file) errors.fail(path, "cannot be opened");
  const Header h = read_header(file.get(), path);
  source.format = fmt::format("LAS 1.{}", h.minor);
  source.crs_wkt = options.crs;
  if (source.crs_wkt.empty()) {
    if (const std::string crs = read_crs(file.get(), path, h); !crs.empty()) {
      try {
        source.crs_wkt = crs_from_text(crs);
      } catch (const std::invalid_argument& error) {
        throw IoError(path, error.what());
      }
    }
  }

  constexpr std::uint64_t at_a_time = 1 << 17;
  std::vector<unsigned char> bytes;
  Points points;
  for (std::uint64_t first = 0; first < h.points; first += at_a_time) {
    run.report(double(first) / double(h.points), "reading points");
    const auto n = std::size_t(std::min(at_a_time, h.points - first));
    bytes =
        read_bytes(file.get(), path, h.first_record + first * h.record_bytes, n * h.record_bytes);
    points = {};
    for (std::size_t i = 0; i < n; ++i) {
      const unsigned char* record = bytes.data() + i * h.record_bytes;
      if (!is_wanted(record, h.format, options.classes)) {
        ++source.other_class;
        continue;
      }
      std::array<std::int32_t, 3> raw{};
      std::memcpy(raw.data(), record, sizeof raw);
      const double z = raw[2] * h.scale[2] + h.offset[2];
      if (options.nodata == z) {
        ++source.without_z;
        continue;
      }
      points.x.push_back(raw[0] * h.scale[0] + h.offset[0]);
      points.y.push_back(raw[1] * h.scale[1] + h.offset[1]);
      points.z.push_back(float(z));
    }
    parts(points);
  }
}

}  // namespace dem::io
