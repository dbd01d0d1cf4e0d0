#include "io/raster/heightmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/images/image_files.h"
#include "io/raster/nodata.h"
#include "io/staged_file.h"

namespace dem::io {
namespace {

// The key under which the range of heights goes along, in Source and in the image's description.
constexpr const char* kRangeKey = "HEIGHT_RANGE";

/// Grey levels are integers 0 ... levels, or floats (levels = 0).
struct Levels {
  CellType type = CellType::uint16;
  double top = 65535;
  SampleType sample = SampleType::uint16;

  bool integer() const { return top > 0; }
};

Levels levels_of(CellType type) {
  if (type == CellType::uint8) return {type, 255, SampleType::uint8};
  if (type == CellType::uint16) return {type, 65535, SampleType::uint16};
  return {CellType::float32, 0, SampleType::float32};
}

std::optional<HeightRange> parse_range(std::string_view text) {
  HeightRange range;
  const auto low = std::from_chars(text.data(), text.data() + text.size(), range.low_m);
  if (low.ec != std::errc() || low.ptr == text.data() + text.size()) return std::nullopt;
  const auto high = std::from_chars(low.ptr + 1, text.data() + text.size(), range.high_m);
  if (high.ec != std::errc() || !(range.high_m > range.low_m)) return std::nullopt;
  return range;
}

void check_range(const HeightRange& range) {
  if (!std::isfinite(range.low_m) || !std::isfinite(range.high_m) || range.low_m >= range.high_m)
    throw std::invalid_argument(fmt::format("heights = {} to {}; the first must be the lower one",
                                            range.low_m, range.high_m));
}

std::optional<HeightRange> described_range(const std::string& description) {
  const std::string begin = std::string(kRangeKey) + "=";
  if (!description.starts_with(begin)) return std::nullopt;
  return parse_range(std::string_view(description).substr(begin.size()));
}

/// Which channel holds the heights.
int choose_channel(const std::string& path, const ImageShape& shape, int asked) {
  if (asked != 0) {
    if (asked < 0 || asked > shape.channels)
      throw IoError(path,
                    fmt::format("has {} channels; band {} was asked for", shape.channels, asked));
    return asked - 1;
  }
  const int colours = shape.channels - (shape.alpha_channel >= 0);
  if (colours != 1)
    throw IoError(path, fmt::format("has {} bands; one must be chosen", colours), "band");
  return shape.alpha_channel == 0 ? 1 : 0;
}

}  // namespace

bool is_image_name(const std::string& path) {
  const std::string ext = extension(path);
  return ext == ".png" || ext == ".exr" || ext == ".jpg" || ext == ".jpeg";
}

DemFile read_heightmap(const std::string& path, const ReadOptions& options, const Run& run) {
  if (options.heights) check_range(*options.heights);
  ImageReader image(path);
  const ImageShape& shape = image.shape();
  const int channel = choose_channel(path, shape, options.band);
  const Levels levels = levels_of(shape.type == SampleType::uint8    ? CellType::uint8
                                  : shape.type == SampleType::uint16 ? CellType::uint16
                                                                     : CellType::float32);
  const Size size{shape.cols, shape.rows};
  const int channels = shape.channels, alpha = shape.alpha_channel;
  const std::vector<float> pixels = image.read(run);

  // Black = low, white = high; without a range the levels themselves are metres.
  std::optional<HeightRange> range = options.heights;
  if (!range) range = described_range(shape.description);
  if (!range && levels.integer()) range = HeightRange{0, levels.top};

  DemFile file;
  file.dem.z = Raster<float>(size);
  file.dem.known = Mask(size, 1);
  ReadOptions value_options = options;
  value_options.detect_nodata = options.detect_nodata && !range;
  NodataSearch search({}, "", value_options);
  const double unknown = options.unknown_grey.value_or(-1);
  std::uint64_t unknown_cells = 0, transparent = 0;
  for (int row = 0; row < size.rows; ++row) {
    const auto z = file.dem.z.row(row);
    const auto known = file.dem.known.row(row);
    for (std::size_t col = 0; col < z.size(); ++col) {
      const std::size_t at = (std::size_t(row) * z.size() + col) * std::size_t(channels);
      const float grey = pixels[at + std::size_t(channel)];
      const double level = levels.integer() ? std::round(double(grey) * levels.top) : double(grey);
      z[col] = !range ? grey
               : levels.integer()
                   ? float(range->low_m + (range->high_m - range->low_m) * level / levels.top)
                   : float(range->low_m + (range->high_m - range->low_m) * level);
      if (alpha >= 0 && alpha != channel && pixels[at + std::size_t(alpha)] == 0) {
        known[col] = 0;
        ++transparent;
      } else if (options.unknown_grey &&
                 level == (levels.integer() ? std::round(unknown * levels.top)
                                            : double(float(unknown)))) {
        known[col] = 0;
        ++unknown_cells;
      }
    }
    search.scan_row(z, known);
  }
  search.clear_sentinels(file.dem.z.cells(), file.dem.known.cells());

  Source& source = file.source;
  source.path = path;
  source.format = "image";
  source.type = levels.type;
  source.evidence = search.evidence();
  if (transparent) source.evidence.push_back({"alpha 0", transparent, true, "the file says so"});
  if (options.unknown_grey)
    source.evidence.push_back(
        {fmt::format("grey {}", *options.unknown_grey), unknown_cells, true, "asked for"});
  if (range)
    source.metadata.emplace_back(kRangeKey, fmt::format("{} {}", range->low_m, range->high_m));
  return file;
}

namespace {

Levels output_levels(const std::string& path, const Source& source, const WriteOptions& options) {
  const std::string ext = extension(path);
  const bool eight_bit_only = ext == ".jpg" || ext == ".jpeg";
  CellType type = ext == ".exr" ? CellType::float32 : CellType::uint16;
  if (source.format == "image" && source.type == CellType::uint8 && ext != ".exr")
    type = CellType::uint8;
  if (eight_bit_only) type = CellType::uint8;
  if (options.type) type = *options.type;
  const bool ok = type == CellType::uint8 || type == CellType::uint16 || type == CellType::float32;
  if (!ok || (type == CellType::float32 && (ext == ".png" || eight_bit_only)) ||
      (type != CellType::float32 && ext == ".exr") || (type != CellType::uint8 && eight_bit_only))
    throw IoError(path, "an image of this format cannot hold cells of the type asked for");
  return levels_of(type);
}

HeightRange extremes(const Dem& dem) {
  HeightRange r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
    if (dem.known.cells()[i]) {
      r.low_m = std::min(r.low_m, double(dem.z.cells()[i]));
      r.high_m = std::max(r.high_m, double(dem.z.cells()[i]));
    }
  if (r.low_m > r.high_m) return {0, 1};                   // nothing known
  if (r.low_m == r.high_m) return {r.low_m, r.low_m + 1};  // a plain
  return r;
}

/// The range asked for, else the one the heights came with if they still lie in it, else theirs.
/// Floats are metres unless a range was asked for.
std::optional<HeightRange> output_range(const std::string& path, const Levels& levels,
                                        const Dem& dem, const Source& source,
                                        const WriteOptions& options) {
  if (!options.heights && !levels.integer()) return std::nullopt;
  const HeightRange own = extremes(dem);
  if (options.heights) {
    check_range(*options.heights);
    if (own.low_m < options.heights->low_m || own.high_m > options.heights->high_m)
      throw IoError(
          path,
          fmt::format("elevations from {} to {} leave the range of heights, {} to {}", own.low_m,
                      own.high_m, options.heights->low_m, options.heights->high_m));
    return options.heights;
  }
  for (const auto& [key, value] : source.metadata)
    if (key == kRangeKey)
      if (const auto kept = parse_range(value);
          kept && own.low_m >= kept->low_m && own.high_m <= kept->high_m)
        return kept;
  return own;
}

/// Grey of a known cell, 0 to 1 (or metres). The grey that means "unknown" is left to the unknown:
/// a known cell that would have it gets the next level.
double grey_of(double height, const std::optional<HeightRange>& range, const Levels& levels,
               std::optional<double> unknown_level) {
  if (!range) return height;
  const double part = (height - range->low_m) / (range->high_m - range->low_m);
  if (!levels.integer()) return part;
  double level = std::round(part * levels.top);
  if (unknown_level && level == *unknown_level) level += level < levels.top ? 1 : -1;
  return level;
}

template <class T>
void write_greys(const std::string& path, const Dem& dem, const Levels& levels,
                 const std::optional<HeightRange>& range, const WriteOptions& options,
                 const Run& run) {
  const auto z = dem.z.cells();
  const auto known = dem.known.cells();
  const bool holes = std::ranges::count(known, 0) > 0;
  const bool with_alpha = holes && !options.unknown_grey;
  std::optional<double> unknown = options.unknown_grey;
  if (unknown && levels.integer()) unknown = std::round(*unknown * levels.top);

  const int channels = with_alpha ? 2 : 1;
  std::vector<T> pixels(z.size() * std::size_t(channels));
  for (std::size_t i = 0; i < z.size(); ++i) {
    T* pixel = pixels.data() + i * std::size_t(channels);
    pixel[0] = T(known[i] ? grey_of(z[i], range, levels, unknown) : unknown.value_or(0));
    if (with_alpha) pixel[1] = T(known[i] ? (levels.integer() ? levels.top : 1) : 0);
  }

  ImageShape shape{.cols = dem.size().cols,
                   .rows = dem.size().rows,
                   .channels = channels,
                   .alpha_channel = with_alpha ? 1 : -1,
                   .type = levels.sample};
  if (range) shape.description = fmt::format("{}={} {}", kRangeKey, range->low_m, range->high_m);
  write_pixels(path, shape, pixels.data(), options.overwrite, run);
}

}  // namespace

void write_heightmap(const std::string& path, const Dem& dem, const Source& source,
                     const WriteOptions& options, const Run& run) {
  if (options.nodata)
    throw IoError(path, "an image has no nodata value; unknown_grey or alpha marks unknown cells");
  if (options.unknown_grey && !(*options.unknown_grey >= 0 && *options.unknown_grey <= 1))
    throw std::invalid_argument(
        fmt::format("unknown_grey = {}; must be in [0, 1]", *options.unknown_grey));
  const Levels levels = output_levels(path, source, options);
  const auto range = output_range(path, levels, dem, source, options);
  if (levels.type == CellType::uint8)
    write_greys<std::uint8_t>(path, dem, levels, range, options, run);
  else if (levels.type == CellType::uint16)
    write_greys<std::uint16_t>(path, dem, levels, range, options, run);
  else
    write_greys<float>(path, dem, levels, range, options, run);
}

}  // namespace dem::io
