// Points in columns of text. The file is read in blocks of whole lines, whose stretches are parsed
// in parallel.

#include <fmt/format.h>

#include <GeographicLib/DMS.hpp>
#include <GeographicLib/GeoCoords.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/points/ogr_layers.h"
#include "io/points/point_reading.h"
#include "io/staged_file.h"
#include "numeric/parallel.h"

namespace dem::io {
using namespace numeric;
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr char spaces = ' ';  // as a delimiter: any number of spaces and tabs

// --- Fields ----------------------------------------------------------------------------------

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && is_space(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_space(s.back())) s.remove_suffix(1);
  return s;
}

std::string_view unquoted(std::string_view s) {
  const bool quoted = s.size() >= 2 && s.front() == '"' && s.back() == '"';
  return quoted ? s.substr(1, s.size() - 2) : s;
}

/// Takes the first field off a line; a line without any more has no data (null).
std::string_view next_field(std::string_view& line, char delimiter) {
  std::size_t n = 0;
  if (delimiter == spaces) {
    line = trimmed(line);
    while (n < line.size() && !is_space(line[n])) ++n;
  } else {
    const std::size_t start = line.find_first_not_of(' ');
    const bool quoted = start != line.npos && line[start] == '"';
    if (quoted) n = std::min(line.size(), line.find('"', start + 1));
    while (n < line.size() && line[n] != delimiter) ++n;
  }
  const std::string_view field = line.substr(0, n);
  line = n < line.size() ? line.substr(n + 1) : std::string_view();
  return unquoted(trimmed(field));
}

std::vector<std::string_view> split(std::string_view line, char delimiter) {
  std::vector<std::string_view> fields;
  while (line.data() != nullptr) fields.push_back(next_field(line, delimiter));
  return fields;
}

bool is_missing(std::string_view field) {
  std::string lower(field);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return char(std::tolower(c)); });
  constexpr std::array names{"",     "nan", "-nan", "na",  "n/a", "null",
                             "none", "-",   "*",    "inf", "-inf"};
  return std::ranges::find(names, lower) != names.end();
}

/// Numbers of at most 15 digits with small exponents: mantissa and power of ten are exact, so one
/// rounding gives the nearest double.
bool parse_short(std::string_view s, char point, double& value) {
  static constexpr std::array<double, 16> tens{1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                               1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const char *c = s.data(), *end = c + s.size();
  const bool negative = c != end && *c == '-';
  if (c != end && (*c == '-' || *c == '+')) ++c;
  std::int64_t mantissa = 0;
  int digits = 0, decimals = 0;
  for (; c != end && unsigned(*c - '0') < 10; ++c, ++digits) mantissa = 10 * mantissa + (*c - '0');
  if (c != end && *c == point) {
    ++c;
    const char* first = c;
    for (; c != end && unsigned(*c - '0') < 10; ++c) mantissa = 10 * mantissa + (*c - '0');
    decimals = int(c - first);
    digits += decimals;
  }
  if (c != end || digits == 0 || digits > 15) return false;
  value = double(mantissa) / tens[std::size_t(decimals)];
  if (negative) value = -value;
  return true;
}

/// Whether the field is a number.
bool parse_number(std::string_view s, char point, double& value) {
  if (s.size() <= 17 && parse_short(s, point, value)) return true;
  std::string text(s);
  if (text.starts_with('+')) text.erase(0, 1);
  if (point == ',') std::ranges::replace(text, ',', '.');
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

// --- Positions as text -----------------------------------------------------------------------

/// Degrees of "46 30 15.5 N", "46d30'15.5\"N", "-7:30" and the like. Throws GeographicErr.
double parse_dms(std::string_view field, GeographicLib::DMS::flag& which) {
  std::string text(trimmed(field)), joined;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != ' ') {
      joined += text[i];
      continue;
    }
    const bool between_digits = !joined.empty() && (std::isdigit(joined.back()) != 0) &&
                                i + 1 < text.size() && (std::isdigit(text[i + 1]) != 0);
    if (between_digits) joined += ':';
  }
  return GeographicLib::DMS::Decode(joined, which);
}

bool is_dms(std::string_view field) {
  double number = 0;
  if (field.empty() || parse_number(field, '.', number)) return false;
  try {
    GeographicLib::DMS::flag which{};
    parse_dms(field, which);
    return true;
  } catch (const GeographicLib::GeographicErr&) {
    return false;
  }
}

// --- Columns ---------------------------------------------------------------------------------

/// How the lines of a file are read. Columns count from 0; -1: there is none.
struct Table {
  char delimiter = spaces, point = '.';
  int x = -1, y = -1, z = -1, sigma = -1, weight = -1, position = -1;
  bool dms = false;
  std::optional<double> nodata;
  int needed() const { return std::max({x, y, z, sigma, weight, position}) + 1; }
};

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '#' || line.front() == '%' || line.front() == '>' ||
         line.starts_with("//");
}

/// The first line that is no comment, taken off `text`; its number is counted on.
std::string_view first_line(std::string_view& text, std::size_t& number) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.size(), text.find('\n'));
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    ++number;
    if (!is_comment(line)) {
      if (line.ends_with('\r')) line.remove_suffix(1);
      return line;
    }
  }
  return {};
}

char find_delimiter(std::string_view line) {
  for (const char c : {'\t', ';', '|', ','})
    if (line.find(c) != line.npos) return c;
  return spaces;
}

bool has_number(const std::vector<std::string_view>& fields) {
  double number = 0;
  return std::ranges::any_of(fields, [&](std::string_view f) {
    return parse_number(f, '.', number) || parse_number(f, ',', number);
  });
}

std::string lower_case(std::string_view s) {
  std::string lower(s);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}
bool is_longitude_name(std::string_view n) {
  return is_one_of(n, {"lon", "long", "longitude", "lng", "londeg", "lon_deg", "x_lon"});
}
bool is_latitude_name(std::string_view n) {
  return is_one_of(n, {"lat", "latitude", "latdeg", "lat_deg", "y_lat"});
}
bool is_x_name(std::string_view n) {
  return is_longitude_name(n) ||
         is_one_of(n, {"x", "east", "easting", "e", "utm_e", "x_m", "x_coord", "xcoord", "x_utm",
                       "utm_x", "rechtswert"});
}
bool is_y_name(std::string_view n) {
  return is_latitude_name(n) || is_one_of(n, {"y", "north", "northing", "n", "utm_n", "y_m",
                                              "y_coord", "ycoord", "y_utm", "utm_y", "hochwert"});
}
bool is_position_name(std::string_view n) { return is_one_of(n, {"mgrs", "utm", "position"}); }

/// Reads off the first lines how the others are to be read.
class Columns {
 public:
  Columns(const std::string& path, const PointReadOptions& options, std::string_view head)
      : path_(path), o_(options) {
    std::string_view rest = head;
    std::size_t line = 0;
    const std::string_view first = first_line(rest, line);
    if (first.empty()) throw IoError(path, "holds no points");
    table_.delimiter = o_.delimiter.value_or(find_delimiter(first));
    if (table_.delimiter == '\t' && first.find('\t') == first.npos) table_.delimiter = spaces;
    table_.nodata = o_.nodata;
    auto fields = split(first, table_.delimiter);
    if (!has_number(fields)) {
      for (const auto f : fields) names_.emplace_back(f);
      header_lines_ = line;
      fields = split(first_line(rest, line), table_.delimiter);
    }
    columns_ = int(std::max(fields.size(), names_.size()));
    if (table_.delimiter != ',') find_decimal_comma(fields);
    choose();
    table_.dms = table_.position < 0 && std::size_t(std::max(table_.x, table_.y)) < fields.size() &&
                 (is_dms(fields[std::size_t(table_.x)]) || is_dms(fields[std::size_t(table_.y)]));
  }

  const Table& table() const { return table_; }
  std::size_t header_lines() const { return header_lines_; }
  bool geographic() const {
    return table_.position >= 0 || table_.dms ||
           (!names_.empty() && is_longitude_name(lower_case(names_[std::size_t(table_.x)])));
  }

  std::string describe() const {
    const auto name = [&](int i) {
      return names_.empty() ? fmt::format("{}", i + 1) : names_[std::size_t(i)];
    };
    std::string text =
        table_.position >= 0
            ? fmt::format("columns: position {}, z {}", name(table_.position), name(table_.z))
            : fmt::format("columns: x {}, y {}, z {}", name(table_.x), name(table_.y),
                          name(table_.z));
    if (table_.sigma >= 0) text += ", sigma " + name(table_.sigma);
    if (table_.weight >= 0) text += ", weight " + name(table_.weight);
    if (table_.dms) text += "; degrees, minutes, seconds";
    if (table_.point == ',') text += "; decimal commas";
    return text;
  }

 private:
  void find_decimal_comma(const std::vector<std::string_view>& fields) {
    double number = 0;
    for (const auto f : fields)
      if (f.find(',') != f.npos && parse_number(f, ',', number)) table_.point = ',';
  }

  template <class Is>
  int find_usual(const Is& is) const {
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (is(lower_case(names_[i]))) return int(i);
    return -1;
  }

  /// The column that an option names.
  int named(const char* option, const std::string& wanted) const {
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (names_[i] == wanted) return int(i);
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (lower_case(names_[i]) == lower_case(wanted)) return int(i);
    int number = 0;
    const char* end = wanted.data() + wanted.size();
    if (std::from_chars(wanted.data(), end, number).ptr == end && number >= 1 && number <= columns_)
      return number - 1;
    throw IoError(path_,
                  fmt::format("{} = {}: no such column; {}", option, wanted, columns_text()));
  }

  std::string columns_text() const {
    return names_.empty() ? fmt::format("it has {} columns without names", columns_)
                          : fmt::format("its columns: {}", fmt::join(names_, ", "));
  }

  void choose() {
    const auto pick = [&](const char* option, const std::string& wanted, const auto& is) {
      return wanted.empty() ? find_usual(is) : named(option, wanted);
    };
    if (!o_.sigma_field.empty()) table_.sigma = named("sigma-field", o_.sigma_field);
    if (!o_.weight_field.empty()) table_.weight = named("weight-field", o_.weight_field);
    table_.x = pick("x-field", o_.x_field, is_x_name);
    table_.y = pick("y-field", o_.y_field, is_y_name);
    table_.z = pick("z-field", o_.z_field, is_elevation_name);
    if (!o_.position_field.empty())
      table_.position = named("position-field", o_.position_field);
    else if (table_.x < 0 && table_.y < 0)
      table_.position = find_usual(is_position_name);
    if (table_.position >= 0) table_.x = table_.y = -1;
    if (names_.empty()) {  // the usual order
      const int first = table_.position >= 0 ? 1 : 2;
      if (table_.position < 0 && table_.x < 0) table_.x = 0;
      if (table_.position < 0 && table_.y < 0) table_.y = 1;
      if (table_.z < 0) table_.z = first;
    }
    const auto missing = [&](const char* what, const char* field) {
      throw IoError(path_, fmt::format("no column is called {} ({})", what, columns_text()), field);
    };
    if (table_.position < 0 && table_.x < 0) missing("x, lon or the like", "x_field");
    if (table_.position < 0 && table_.y < 0) missing("y, lat or the like", "y_field");
    if (table_.z < 0) missing("z, elevation or the like", "z_field");
    if (table_.needed() > columns_)
      throw IoError(path_,
                    fmt::format("line {}: {} column{}; must have at least {}", header_lines_ + 1,
                                columns_, columns_ == 1 ? "" : "s", table_.needed()));
  }

  const std::string& path_;
  const PointReadOptions& o_;
  Table table_;
  std::vector<std::string> names_;
  int columns_ = 0;
  std::size_t header_lines_ = 0;
};

// --- Lines -----------------------------------------------------------------------------------

/// What was parsed of a stretch of lines.
struct Stretch {
  std::string_view text;
  Points points;
  std::size_t lines = 0, without_z = 0;
  std::string error;  // at line `lines`
};

class LineParser {
 public:
  explicit LineParser(const Table& table) : t_(table), fields_(std::size_t(table.needed())) {}

  void parse(Stretch& s) {
    std::string_view text = s.text;
    while (!text.empty() && s.error.empty()) {
      const void* newline = std::memchr(text.data(), '\n', text.size());
      const std::size_t end = newline == nullptr
                                  ? text.size()
                                  : std::size_t(static_cast<const char*>(newline) - text.data());
      ++s.lines;
      parse_line(text.substr(0, end), s);
      text.remove_prefix(std::min(text.size(), end + 1));
    }
  }

 private:
  void parse_line(std::string_view line, Stretch& s) {
    if (is_comment(line)) return;
    if (line.back() == '\r') line.remove_suffix(1);
    std::size_t n = 0;
    while (n < fields_.size() && line.data() != nullptr)
      fields_[n++] = next_field(line, t_.delimiter);
    if (n < fields_.size()) {
      s.error =
          fmt::format("{} column{}; must have at least {}", n, n == 1 ? "" : "s", fields_.size());
      return;
    }
    double x = no_number, y = no_number;
    const double z = number("z", t_.z, s);
    if (t_.position >= 0)
      position(x, y, s);
    else if (t_.dms)
      degrees(x, y, s);
    else
      x = number("x", t_.x, s), y = number("y", t_.y, s);
    const double sigma = t_.sigma < 0 ? 1 : number("sigma", t_.sigma, s);
    const double weight = t_.weight < 0 ? 1 : number("weight", t_.weight, s);
    if (!s.error.empty()) return;
    if (std::isnan(x + y + z + sigma + weight) || t_.nodata == z) {
      ++s.without_z;
      return;
    }
    if (!(sigma > 0)) s.error = fmt::format("sigma = {}; must be above 0", sigma);
    if (!(weight > 0)) s.error = fmt::format("weight = {}; must be above 0", weight);
    s.points.x.push_back(x);
    s.points.y.push_back(y);
    s.points.z.push_back(float(z));
    if (t_.sigma >= 0) s.points.sigma.push_back(float(sigma));
    if (t_.weight >= 0) s.points.weight.push_back(float(weight));
  }

  double number(const char* name, int column, Stretch& s) const {
    const std::string_view field = fields_[std::size_t(column)];
    double value = no_number;
    if (!parse_number(field, t_.point, value) && !is_missing(field) && s.error.empty())
      s.error = fmt::format("{} = {}; must be a number", name, field);
    return value;
  }

  void degrees(double& x, double& y, Stretch& s) const {
    using GeographicLib::DMS;
    const std::string_view fx = fields_[std::size_t(t_.x)], fy = fields_[std::size_t(t_.y)];
    if (is_missing(fx) || is_missing(fy)) return;
    try {
      DMS::flag of_x{}, of_y{};
      x = parse_dms(fx, of_x);
      y = parse_dms(fy, of_y);
      // A letter says what a number is, whatever the column is called.
      if (of_x == DMS::LATITUDE && of_y != DMS::LATITUDE)
        std::swap(x, y);
      else if (of_x == DMS::LATITUDE || (of_y == DMS::LONGITUDE && of_x == DMS::LONGITUDE))
        s.error = fmt::format("{} and {} are both of one kind", fx, fy);
      else if (of_y == DMS::LONGITUDE)
        std::swap(x, y);
    } catch (const GeographicLib::GeographicErr&) {
      s.error = fmt::format("x = {}, y = {}; must be degrees, minutes, seconds", fx, fy);
    }
  }

  void position(double& x, double& y, Stretch& s) const {
    const std::string_view field = fields_[std::size_t(t_.position)];
    if (is_missing(field)) return;
    try {
      const GeographicLib::GeoCoords at{std::string(field)};
      x = at.Longitude();
      y = at.Latitude();
    } catch (const GeographicLib::GeographicErr&) {
      s.error = fmt::format(
          "position = {}; must be MGRS, UTM (32T 465005 5080000) or latitude and longitude", field);
    }
  }

  const Table& t_;
  std::vector<std::string_view> fields_;
};

/// Cuts text into `n` stretches of whole lines.
std::vector<Stretch> cut(std::string_view text, std::size_t n) {
  std::vector<Stretch> stretches;
  while (!text.empty()) {
    std::size_t end = std::min(text.size(), text.size() / std::max<std::size_t>(1, n) + 1);
    end = text.find('\n', end - 1);
    end = end == text.npos ? text.size() : end + 1;
    stretches.push_back({text.substr(0, end), {}, 0, 0, {}});
    text.remove_prefix(end);
    if (n > 1) --n;
  }
  return stretches;
}

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// A file in blocks of whole lines.
class Blocks {
 public:
  explicit Blocks(const std::string& path) : path_(path) {
    std::string vsi = path == "-" ? "/vsistdin/" : path;
    if (extension(path) == ".gz" && !path.starts_with("/vsi")) vsi = "/vsigzip/" + path;
    file_.reset(VSIFOpenL(vsi.c_str(), "rb"));
    if (!file_) errors_.fail(path, "cannot be opened");
    VSIStatBufL stat;
    if (vsi == path && VSIStatL(path.c_str(), &stat) == 0) bytes_ = double(stat.st_size);
  }

  /// The next whole lines, "" at the end. They live until the next call.
  std::string_view next() {
    constexpr std::size_t block_bytes = std::size_t(4) << 20;
    buffer_.erase(0, taken_);
    while (true) {
      const std::size_t had = buffer_.size();
      buffer_.resize(had + block_bytes);
      const std::size_t got = VSIFReadL(buffer_.data() + had, 1, block_bytes, file_.get());
      buffer_.resize(had + got);
      read_ += double(got);
      if (got < block_bytes && errors_.any()) errors_.fail(path_, "cannot be read");
      const std::size_t newline = buffer_.rfind('\n');
      taken_ = got == 0 ? buffer_.size() : newline == buffer_.npos ? 0 : newline + 1;
      if (taken_ > 0 || got == 0) break;
      if (buffer_.size() > 16 * block_bytes)
        throw IoError(path_, "has no lines: no text with columns");
    }
    if (std::memchr(buffer_.data(), 0, std::min<std::size_t>(taken_, 4096)) != nullptr)
      throw IoError(path_, "is no text with columns: it holds bytes of 0");
    return std::string_view(buffer_).substr(0, taken_);
  }

  double part() const { return bytes_ > 0 ? std::min(1., read_ / bytes_) : 0; }

 private:
  std::string path_;
  GdalErrors errors_;
  std::unique_ptr<VSILFILE, CloseFile> file_;
  std::string buffer_;
  std::size_t taken_ = 0;
  double bytes_ = 0, read_ = 0;
};

}  // namespace

void read_text_points(const std::string& path, const PointReadOptions& options, PointSource& source,
                      const PointParts& parts, const Run& run) {
  if (!options.layer.empty())
    throw IoError(path, "is text, which has no layers; layer is for vector files");
  if (!options.classes.empty())
    throw IoError(path, "is text, which has no classes; class is for LAS files");
  Blocks blocks(path);
  std::string_view block = blocks.next();
  if (block.empty()) throw IoError(path, "is empty");
  if (block.starts_with("\xef\xbb\xbf")) block.remove_prefix(3);  // byte order mark
  const Columns columns(path, options, block.substr(0, std::size_t(1) << 16));
  source.format = "text";
  source.notes.push_back(columns.describe());
  source.crs_wkt = options.crs;
  if (options.crs.empty() && columns.geographic()) {
    source.crs_wkt = wgs84();
    source.notes.push_back("longitude and latitude: taken as WGS 84");
  }

  std::size_t line = columns.header_lines();
  for (std::size_t i = 0; i < line; ++i)
    block.remove_prefix(std::min(block.size(), block.find('\n') + 1));
  const std::size_t stretches_n = with_threads(
      run.threads, [] { return std::size_t(tbb::this_task_arena::max_concurrency()); });
  while (!block.empty()) {
    run.report(blocks.part(), "reading points");
    auto stretches = cut(block, stretches_n);
    with_threads(run.threads, [&] {
      parallel_for(0, int(stretches.size()), 1,
                   [&](int i) { LineParser(columns.table()).parse(stretches[std::size_t(i)]); });
    });
    for (Stretch& s : stretches) {
      line += s.lines;
      if (!s.error.empty()) throw IoError(path, fmt::format("line {}: {}", line, s.error));
      source.without_z += s.without_z;
      parts(s.points);
    }
    block = blocks.next();
  }
}

}  // namespace dem::io
