#include "io/raster/hgt.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>
#include <span>

#include "io/gdal_support.h"
#include "io/raster/cells.h"
#include "io/raster/nodata.h"

namespace dem::io {
namespace {

constexpr int kVoid = -32768;
constexpr int kRowsAtOnce = 256;
constexpr std::array kUsualSizes{1201, 3601, 7201};
constexpr std::size_t kMaxSize = 46341;  // larger squares have more than 2^31 cells

struct CloseVsi {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};
using VsiFile = std::unique_ptr<VSILFILE, CloseVsi>;

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// "a/b/N36E008.hgt.zip" -> "N36E008.hgt.zip"
std::string base_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// South-west corner of a tile, in whole degrees.
struct Corner {
  int lon = 0, lat = 0;
  bool operator==(const Corner&) const = default;
};

/// Finds N36E008, s12w077, n36_e008 ... anywhere in a name.
std::optional<Corner> find_corner(const std::string& name) {
  static const std::regex pattern("([ns])([0-9]{2,3})[_-]?([ew])([0-9]{3})", std::regex::icase);
  for (std::sregex_iterator it(name.begin(), name.end(), pattern), end; it != end; ++it) {
    const int lat = std::stoi((*it)[2]), lon = std::stoi((*it)[4]);
    const Corner corner{lower((*it)[3]) == "w" ? -lon : lon, lower((*it)[1]) == "s" ? -lat : lat};
    if (corner.lat >= -90 && corner.lat < 90 && corner.lon >= -180 && corner.lon <= 180)
      return corner;
  }
  return std::nullopt;
}

std::string tile_name(Corner corner) {
  return fmt::format("{}{:02}{}{:03}", corner.lat < 0 ? 'S' : 'N', std::abs(corner.lat),
                     corner.lon < 0 ? 'W' : 'E', std::abs(corner.lon));
}

std::string wgs84_wkt() {
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  char* text = nullptr;
  crs.exportToWkt(&text);
  const std::unique_ptr<char, decltype(&VSIFree)> owned(text, VSIFree);
  return owned.get();
}

/// Nodes from edge to edge: the first one at the tile's north-west corner.
GeoRef tile_ref(Corner corner, int size) {
  const double step = 1.0 / (size - 1);
  return {{double(corner.lon), step, 0, double(corner.lat + 1), 0, -step}, wgs84_wkt()};
}

// --- Bytes ----------------------------------------------------------------------------------

/// The only .hgt inside a zip, whatever its name.
std::string entry_of_zip(const std::string& path, const std::string& zip) {
  const CPLStringList names(VSIReadDirRecursive(zip.c_str()));
  std::vector<std::string> found;
  for (int i = 0; i < names.size(); ++i)
    if (lower(names[i]).ends_with(".hgt")) found.push_back(names[i]);
  if (found.size() == 1) return zip + "/" + found[0];
  if (names.empty()) throw IoError(path, "is not a zip archive, or an empty one");
  throw IoError(path, found.empty()
                          ? "holds no .hgt"
                          : fmt::format("holds {} .hgt files; must be one", found.size()));
}

/// The path that GDAL's virtual file system reads or writes the raw heights at.
std::string vsi_path(const std::string& path, bool writing) {
  const std::string name = lower(path);
  if (name.ends_with(".gz")) return name.starts_with("/vsigzip/") ? path : "/vsigzip/" + path;
  if (!name.ends_with(".zip")) return path;
  // In braces, or GDAL would look for the archive in the first folder with ".zip" in its name.
  const std::string plain = name.starts_with("/vsizip/") ? path.substr(8) : path;
  const std::string zip = fmt::format("/vsizip/{{{}}}", plain);
  if (!writing) return entry_of_zip(path, zip);
  const std::string base = base_name(path);
  return zip + "/" + base.substr(0, base.size() - 4);
}

std::vector<std::uint8_t> read_bytes(const std::string& path, const std::string& vsi,
                                     const GdalErrors& errors, const Run& run) {
  const VsiFile file(VSIFOpenL(vsi.c_str(), "rb"));
  if (!file) errors.fail(path, "no such file, or it cannot be read");
  constexpr std::size_t kChunk = std::size_t{1} << 22;
  std::vector<std::uint8_t> bytes;
  for (;;) {
    const std::size_t have = bytes.size();
    bytes.resize(have + kChunk);
    const std::size_t got = VSIFReadL(bytes.data() + have, 1, kChunk, file.get());
    bytes.resize(have + got);
    if (errors.any()) errors.fail(path, "cannot be read");
    if (got < kChunk) return bytes;
    if (bytes.size() > 2 * kMaxSize * kMaxSize) throw IoError(path, "too large for an .hgt");
    run.report(0, "reading");
  }
}

// --- What a wrong file is ---------------------------------------------------------------------

bool is_text(std::span<const std::uint8_t> bytes) {
  return std::ranges::all_of(bytes.first(std::min<std::size_t>(bytes.size(), 64)), [](auto b) {
    return (b >= ' ' && b < 127) || b == '\n' || b == '\r' || b == '\t';
  });
}

std::string first_characters(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (auto b : bytes.first(std::min<std::size_t>(bytes.size(), 40)))
    text += b >= ' ' && b < 127 ? char(b) : ' ';
  return text + (bytes.size() > 40 ? "..." : "");
}

/// What the bytes are, when their beginning shows that they are no heights; else "". When the size
/// is right, only a bracket counts as text: read as a height it is above 15000 m.
std::string other_format(std::span<const std::uint8_t> bytes, bool right_size) {
  const auto begins = [&](std::string_view magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  using namespace std::string_view_literals;
  if (begins("II*\0"sv) || begins("MM\0*"sv) || begins("II+\0"sv) || begins("MM\0+"sv))
    return "is a TIFF, not an .hgt; name it .tif";
  if (begins("PK\3\4"sv)) return "is a zip archive, not an .hgt; name it .hgt.zip";
  if (begins("\x1f\x8b\x08"sv)) return "is gzip-compressed, not an .hgt; name it .hgt.gz";
  const auto text = std::ranges::find_if_not(bytes, [](auto b) { return std::isspace(b); });
  const std::span<const std::uint8_t> rest(text, bytes.end());
  if (rest.empty() || !is_text(bytes)) return "";
  if (right_size && bytes[0] != '{' && bytes[0] != '[' && bytes[0] != '<') return "";
  const char* kind =
      rest[0] == '{' || rest[0] == '[' ? "JSON"
      : rest[0] == '<'
          ? (lower(first_characters(rest)).find("html") != std::string::npos ? "an HTML page"
                                                                             : "XML")
          : "text";
  return fmt::format("is not an .hgt but looks like {}: {}", kind, first_characters(rest));
}

/// Cells to a side, or an IoError that says what the file is instead.
int checked_size(const std::string& path, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) throw IoError(path, "is empty (0 bytes)");
  const auto side = std::max<std::int64_t>(2, std::llround(std::sqrt(double(bytes.size()) / 2)));
  const auto size_of = [](std::int64_t n) { return 2 * n * n; };
  const bool right_size = size_of(side) == std::int64_t(bytes.size());
  if (const std::string what = other_format(bytes, right_size); !what.empty())
    throw IoError(path, what);
  if (right_size) return int(side);
  const int usual = *std::ranges::min_element(
      kUsualSizes, {}, [&](int n) { return std::abs(size_of(n) - std::int64_t(bytes.size())); });
  std::string nearest = fmt::format("{} for {} x {}", size_of(side), side, side);
  if (usual != side)
    nearest +=
        fmt::format(" and, of the usual sizes, {} for {} x {}", size_of(usual), usual, usual);
  throw IoError(path,
                fmt::format("has {} bytes, which is no square of 16-bit heights (truncated?); "
                            "nearest: {}",
                            bytes.size(), nearest));
}

Corner corner_of(const std::string& path, const std::string& vsi, const ReadOptions& options) {
  if (!options.tile.empty()) {
    if (const auto corner = find_corner(options.tile)) return *corner;
    throw IoError(path, fmt::format("tile = {}; must be like N36E008", options.tile));
  }
  for (const std::string& name : {base_name(path), base_name(vsi)})
    if (const auto corner = find_corner(name)) return *corner;
  throw IoError(path, "its name does not say which tile it is, such as N36E008", "tile");
}

}  // namespace

bool is_hgt_name(const std::string& path) {
  const std::string name = lower(path);
  return name.ends_with(".hgt") || name.ends_with(".hgt.gz") || name.ends_with(".hgt.zip");
}

DemFile read_hgt(const std::string& path, const ReadOptions& options, const Run& run) {
  if (options.band > 1)
    throw IoError(path, fmt::format("has 1 band; band {} was asked for", options.band));
  const GdalErrors errors;
  const std::string vsi = vsi_path(path, false);
  const auto bytes = read_bytes(path, vsi, errors, run);
  const int n = checked_size(path, bytes);

  DemFile file;
  file.dem.ref = tile_ref(corner_of(path, vsi, options), n);
  file.dem.z = Raster<float>({n, n});
  file.dem.known = Mask({n, n}, 1);
  NodataSearch search(kVoid, "void of .hgt,", options);
  for (int row = 0; row < n; ++row) {
    if (row % kRowsAtOnce == 0) run.report(double(row) / n, "reading");
    const std::uint8_t* in = bytes.data() + std::size_t(row) * std::size_t(n) * 2;
    const auto out = file.dem.z.row(row);
    for (int col = 0; col < n; ++col)
      out[std::size_t(col)] =
          float(std::int16_t(std::uint16_t(in[2 * col] << 8 | in[2 * col + 1])));
    search.scan_row(out, file.dem.known.row(row));
  }
  search.clear_sentinels(file.dem.z.cells(), file.dem.known.cells());

  file.source.path = path;
  file.source.format = "HGT";
  file.source.type = CellType::int16;
  file.source.nodata = kVoid;
  file.source.node_registered = true;
  file.source.vertical_datum = "EGM96, assumed for .hgt";
  file.source.evidence = search.evidence();
  return file;
}

namespace {

/// Refuses what the format cannot say.
void check_hgt(const std::string& path, Size size, const GeoRef& ref, const WriteOptions& options) {
  const auto [cols, rows] = size;
  if (cols != rows || cols < 2)
    throw IoError(path,
                  fmt::format("{} x {} cells; an .hgt is a square of at least 2 x 2", cols, rows));
  if (options.type.value_or(CellType::int16) != CellType::int16)
    throw IoError(path, "an .hgt holds int16 only");
  if (options.nodata.value_or(kVoid) != kVoid)
    throw IoError(path, fmt::format("nodata {}; an .hgt has {} only", *options.nodata, kVoid));
  if (!options.metadata.empty()) throw IoError(path, "an .hgt holds no metadata");

  // Its place is in its name alone, so the two must not contradict each other.
  if (ref == GeoRef{}) return;
  const auto& at = ref.to_world;
  const double step = 1.0 / (cols - 1), slack = 0.01 * step;
  const auto same = [&](double a, double b) { return std::abs(a - b) <= slack; };
  const Corner corner{int(std::lround(at[0])), int(std::lround(at[3])) - 1};
  const bool one_tile = same(at[0], corner.lon) && same(at[3], corner.lat + 1) &&
                        same(at[1] * (cols - 1), 1) && same(at[5] * (cols - 1), -1) && at[2] == 0 &&
                        at[4] == 0;
  if (!one_tile)
    throw IoError(
        path, "the cells are not the nodes of a one-degree tile; an .hgt can hold nothing else");
  const auto named = find_corner(base_name(path));
  if (named && *named != corner)
    throw IoError(path, "the name says another tile than the cells, " + tile_name(corner));
}

}  // namespace

HgtWriter::HgtWriter(const std::string& path, Size size, const GeoRef& ref,
                     const WriteOptions& options)
    : path_((check_hgt(path, size, ref, options), path)), staged_(path, options.overwrite) {
  const GdalErrors errors;
  file_.reset(VSIFOpenL(vsi_path(staged_.path(), true).c_str(), "wb"));
  if (!file_) errors.fail(path, "cannot be created");
}

void HgtWriter::write(std::span<const float> z, std::span<const std::uint8_t> known) {
  std::vector<std::int16_t> heights(z.size());
  if (!to_cells<std::int16_t>(path_, z, {}, known, kVoid, heights))
    throw IoError(path_, fmt::format("an elevation is {}, which means void in an .hgt", kVoid));
  std::vector<std::uint8_t> bytes(2 * z.size());
  for (std::size_t i = 0; i < z.size(); ++i) {
    const auto height = std::uint16_t(heights[i]);
    bytes[2 * i] = std::uint8_t(height >> 8);
    bytes[2 * i + 1] = std::uint8_t(height & 0xff);
  }
  const GdalErrors errors;
  if (VSIFWriteL(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() || errors.any())
    errors.fail(path_, "cannot be written to the end; is the disk full?");
}

void HgtWriter::close() {
  const GdalErrors errors;
  if (VSIFCloseL(file_.release()) != 0 || errors.any())
    errors.fail(path_, "cannot be written to the end; is the disk full?");
}

std::vector<HgtTile> hgt_tiles(const std::string& path, Size size, const GeoRef& ref) {
  const auto& at = ref.to_world;
  const int cells = at[1] > 0 ? int(std::min(std::lround(1 / at[1]), 46340l)) : 0;  // to a degree
  const auto near = [&](double a, double b) { return std::abs(a - b) * cells <= 0.01; };
  const double west = std::round(at[0]), north = std::round(at[3]);
  const bool whole = cells >= 1 && near(at[0], west) && near(at[3], north) && at[2] == 0 &&
                     at[4] == 0 && near(at[1] * cells, 1) && near(at[5] * cells, -1) &&
                     size.cols > cells && size.rows > cells && (size.cols - 1) % cells == 0 &&
                     (size.rows - 1) % cells == 0;
  if (!whole)
    throw IoError(path,
                  "the cells are not the nodes of whole one-degree tiles, which .hgt files hold");
  std::vector<HgtTile> tiles;
  for (int row = 0; row + 1 < size.rows; row += cells)
    for (int col = 0; col + 1 < size.cols; col += cells)
      tiles.push_back({tile_name({int(west) + col / cells, int(north) - 1 - row / cells}) + ".hgt",
                       {col, row, cells + 1, cells + 1}});
  return tiles;
}

}  // namespace dem::io
