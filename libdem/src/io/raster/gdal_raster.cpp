#include "io/raster/gdal_raster.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "io/gdal_support.h"
#include "io/raster/cells.h"
#include "io/raster/nodata.h"
#include "io/raster/tile_folder.h"
#include "io/staged_file.h"

namespace dem::io {
namespace {

constexpr int kRowsAtOnce = 256;

std::string text_or_empty(const char* text) { return text ? text : ""; }

// --- Reading: which band, of what type ---------------------------------------------------------

GDALRasterBandH choose_band(const std::string& path, GDALDatasetH dataset, int asked) {
  const int bands = GDALGetRasterCount(dataset);
  if (bands == 0) throw IoError(path, "holds no band of cells; a subdataset may be meant");
  if (asked != 0) {
    if (asked < 0 || asked > bands)
      throw IoError(path, fmt::format("has {} band{}; band {} was asked for", bands,
                                      bands == 1 ? "" : "s", asked));
    return GDALGetRasterBand(dataset, asked);
  }
  int candidates = 0;
  GDALRasterBandH found = nullptr;
  for (int b = bands; b >= 1; --b) {
    const GDALRasterBandH band = GDALGetRasterBand(dataset, b);
    if (GDALGetRasterColorInterpretation(band) == GCI_AlphaBand) continue;
    ++candidates;
    found = band;
  }
  if (candidates == 1) return found;
  throw IoError(path, fmt::format("has {} bands; one must be chosen", bands), "band");
}

bool is_signed_byte(GDALRasterBandH band) {
  return GDALGetRasterDataType(band) == GDT_Byte &&
         text_or_empty(GDALGetMetadataItem(band, "PIXELTYPE", "IMAGE_STRUCTURE")) == "SIGNEDBYTE";
}

CellType cell_type(const std::string& path, GDALRasterBandH band) {
  const GDALDataType type = GDALGetRasterDataType(band);
  switch (type) {
    case GDT_Byte:
      return is_signed_byte(band) ? CellType::int8 : CellType::uint8;
    case GDT_Int16:
      return CellType::int16;
    case GDT_UInt16:
      return CellType::uint16;
    case GDT_Int32:
      return CellType::int32;
    case GDT_UInt32:
      return CellType::uint32;
    case GDT_Float32:
      return CellType::float32;
    case GDT_Float64:
    case GDT_Int64:
    case GDT_UInt64:
      return CellType::float64;
    default:
      throw IoError(path, fmt::format("has cells of type {}; elevations must be real numbers",
                                      GDALGetDataTypeName(type)));
  }
}

// --- Reading: units --------------------------------------------------------------------------

/// Metres in one unit of height, for the names that files use; 0 for names not known.
double metres_in(std::string unit) {
  static const std::map<std::string, double> units{{"m", 1},
                                                   {"metre", 1},
                                                   {"meter", 1},
                                                   {"metres", 1},
                                                   {"meters", 1},
                                                   {"ft", 0.3048},
                                                   {"foot", 0.3048},
                                                   {"feet", 0.3048},
                                                   {"international foot", 0.3048},
                                                   {"us-ft", 1200.0 / 3937},
                                                   {"ftus", 1200.0 / 3937},
                                                   {"us survey foot", 1200.0 / 3937},
                                                   {"foot_us", 1200.0 / 3937},
                                                   {"cm", 0.01},
                                                   {"dm", 0.1},
                                                   {"mm", 0.001},
                                                   {"km", 1000}};
  std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const auto found = units.find(unit);
  return found == units.end() ? 0 : found->second;
}

/// height in metres = raw * scale + offset, and how that came about.
struct ToMetres {
  double scale = 1, offset = 0;
  std::string said;

  bool needed() const { return scale != 1 || offset != 0; }
};

struct Crs {
  std::string wkt, vertical_datum;
  double vertical_unit_m = 1;
};

Crs read_crs(GDALDatasetH dataset) {
  OGRSpatialReferenceH handle = GDALGetSpatialRef(dataset);
  if (!handle) return {};
  OGRSpatialReference crs(*OGRSpatialReference::FromHandle(handle));
  Crs out;
  if (crs.IsCompound()) {
    out.vertical_datum = text_or_empty(crs.GetAttrValue("COMPD_CS|VERT_CS"));
    const char* unit = nullptr;
    out.vertical_unit_m = crs.GetTargetLinearUnits("COMPD_CS|VERT_CS", &unit);
    // Heights become metres, so a vertical CRS in feet would no longer be true.
    if (out.vertical_unit_m != 1) crs.StripVertical();
  }
  char* text = nullptr;
  const char* const wkt2[] = {"FORMAT=WKT2_2018", nullptr};
  if (crs.exportToWkt(&text) != OGRERR_NONE) {
    CPLFree(text);
    text = nullptr;
    crs.exportToWkt(&text, wkt2);
  }
  out.wkt = text_or_empty(text);
  CPLFree(text);
  return out;
}

ToMetres to_metres(GDALRasterBandH band, const Crs& crs) {
  ToMetres t{GDALGetRasterScale(band, nullptr), GDALGetRasterOffset(band, nullptr), ""};
  if (t.needed()) t.said = fmt::format("file value * {} + {}", t.scale, t.offset);
  const std::string unit = text_or_empty(GDALGetRasterUnitType(band));
  const double factor = unit.empty() ? crs.vertical_unit_m : metres_in(unit);
  if (factor != 0 && factor != 1) {
    t.scale *= factor;
    t.offset *= factor;
    t.said += fmt::format("{}converted from {} ({} m)", t.said.empty() ? "" : ", ",
                          unit.empty() ? "the unit of the vertical CRS" : unit, factor);
  }
  return t;
}

// --- Reading: the rest of what the file says -----------------------------------------------------

/// GDAL's origin is the corner of the first cell, ours its centre.
std::array<double, 6> centres(const std::array<double, 6>& corner) {
  auto at = corner;
  at[0] += 0.5 * (corner[1] + corner[2]);
  at[3] += 0.5 * (corner[4] + corner[5]);
  return at;
}

std::array<double, 6> corners(const std::array<double, 6>& centre) {
  auto at = centre;
  at[0] -= 0.5 * (centre[1] + centre[2]);
  at[3] -= 0.5 * (centre[4] + centre[5]);
  return at;
}

/// Metadata worth keeping: not what write_dem says by itself, nor statistics of the old heights.
void append_metadata(GDALMajorObjectH object, Source& source) {
  for (CSLConstList item = GDALGetMetadata(object, nullptr); item && *item; ++item) {
    char* key = nullptr;
    const char* value = CPLParseNameValue(*item, &key);
    const std::string name = text_or_empty(key);
    CPLFree(key);
    const bool told = std::ranges::any_of(source.metadata,
                                          [&](const auto& entry) { return entry.first == name; });
    if (value && !told && name != "AREA_OR_POINT" && !name.starts_with("STATISTICS_"))
      source.metadata.emplace_back(name, value);
  }
}

/// The no-data value a band declares, in the type it has.
std::optional<double> declared_nodata(GDALRasterBandH band) {
  int has = FALSE;
  double value = 0;
  switch (GDALGetRasterDataType(band)) {
    case GDT_Int64:
      value = double(GDALGetRasterNoDataValueAsInt64(band, &has));
      break;
    case GDT_UInt64:
      value = double(GDALGetRasterNoDataValueAsUInt64(band, &has));
      break;
    default:
      value = GDALGetRasterNoDataValue(band, &has);
  }
  if (!has) return std::nullopt;
  return is_signed_byte(band) && value > 127 ? value - 256 : value;
}

/// A mask of its own (not one that GDAL derives from the no-data value), or null.
GDALRasterBandH mask_band(GDALRasterBandH band) {
  const int flags = GDALGetMaskFlags(band);
  if (flags & GMF_ALL_VALID) return nullptr;
  if ((flags & GMF_NODATA) && !(flags & GMF_PER_DATASET)) return nullptr;
  return GDALGetMaskBand(band);
}

// --- Reading: the cells --------------------------------------------------------------------------

/// Reads the band row block by row block, and looks at each row while it is at hand.
template <class T>
void read_cells(const std::string& path, GDALRasterBandH band, const GdalErrors& errors,
                NodataSearch& search, Raster<T>& cells, Mask& known, const Run& run) {
  const auto [cols, rows] = cells.size();
  const GDALDataType type = std::is_same_v<T, float> ? GDT_Float32 : GDT_Float64;
  const GDALRasterBandH mask = mask_band(band);
  const bool signed_byte = is_signed_byte(band);
  for (int row = 0; row < rows; row += kRowsAtOnce) {
    run.report(double(row) / rows, "reading");
    const int n = std::min(kRowsAtOnce, rows - row);
    CPLErr error =
        GDALRasterIO(band, GF_Read, 0, row, cols, n, cells.row(row).data(), cols, n, type, 0, 0);
    if (mask && error == CE_None)
      error = GDALRasterIO(mask, GF_Read, 0, row, cols, n, known.row(row).data(), cols, n, GDT_Byte,
                           0, 0);
    if (error != CE_None || errors.any()) errors.fail(path, "cells cannot be read");
    for (int r = row; r < row + n; ++r) {
      if (mask) {
        const auto flags = known.row(r);
        std::ranges::transform(flags, flags.begin(), [](auto m) { return std::uint8_t(m != 0); });
        search.count_masked(std::uint64_t(std::ranges::count(flags, 0)));
      }
      if (signed_byte)
        for (T& v : cells.row(r)) v = v > 127 ? v - 256 : v;
      search.scan_row(cells.row(r), known.row(r));
    }
  }
  search.clear_sentinels(cells.cells(), known.cells());
}

/// Rounds to float32 and keeps the doubles only when they say more.
void round_to_floats(Raster<double>&& exact, DemFile& file) {
  const auto from = exact.cells();
  const auto to = file.dem.z.cells();
  bool same = true;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i] = float(from[i]);
    same &= double(to[i]) == from[i];
  }
  if (!same) file.source.exact = std::move(exact);
}

template <class T>
void flip_rows(Raster<T>& raster) {
  for (int top = 0, bottom = raster.rows() - 1; top < bottom; ++top, --bottom)
    std::ranges::swap_ranges(raster.row(top), raster.row(bottom));
}

/// Row 0 becomes the north when the file begins in the south.
void turn_north_up(DemFile& file) {
  auto& at = file.dem.ref.to_world;
  if (!(at[5] > 0) || at[2] != 0 || at[4] != 0) return;
  at[3] += at[5] * (file.dem.z.rows() - 1);
  at[5] = -at[5];
  flip_rows(file.dem.z);
  flip_rows(file.dem.known);
  if (!file.source.exact.empty()) flip_rows(file.source.exact);
}

}  // namespace

namespace {

/// Tiles as one raster.
DatasetPtr open_tiles(const std::string& path, const std::vector<std::string>& tiles,
                      const GdalErrors& errors) {
  CPLStringList names;
  for (const std::string& tile : tiles) names.AddString(tile.c_str());
  CPLStringList flags;
  flags.AddString("-strict");  // a tile that cannot be read is an error
  const std::unique_ptr<GDALBuildVRTOptions, decltype(&GDALBuildVRTOptionsFree)> options(
      GDALBuildVRTOptionsNew(flags.List(), nullptr), GDALBuildVRTOptionsFree);
  DatasetPtr mosaic(GDALBuildVRT("", names.size(), nullptr, names.List(), options.get(), nullptr));
  if (!mosaic) errors.fail(path, "its tiles do not make one raster");
  return mosaic;
}

}  // namespace

OpenBand open_band(const std::string& path, const ReadOptions& options, GdalErrors& errors) {
  register_gdal();
  OpenBand open;
  std::error_code error;  // then GDAL says what is wrong with it
  if (std::filesystem::is_directory(path, error))
    open.dataset = open_tiles(path, tiles_in(path), errors);
  else if (is_list_of_files(path))
    open.dataset = open_tiles(path, files_of_list(path), errors);
  else
    open.dataset.reset(GDALOpenEx(path.c_str(),
                                  GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                                  nullptr, nullptr, nullptr));
  if (!open.dataset) errors.fail(path, "cannot be opened");
  errors.clear();  // a driver that was tried in vain may have complained
  const GDALDatasetH dataset = open.dataset.get();
  const GDALRasterBandH band = open.band = choose_band(path, dataset, options.band);
  const CellType type = cell_type(path, band);
  const Crs crs = read_crs(dataset);
  const ToMetres metres = to_metres(band, crs);

  Source& source = open.source;
  source.path = path;
  source.format = GDALGetDriverShortName(GDALGetDatasetDriver(dataset));
  source.type = type;
  source.vertical_datum = crs.vertical_datum;
  source.band_description = GDALGetDescription(band);
  source.node_registered =
      text_or_empty(GDALGetMetadataItem(dataset, "AREA_OR_POINT", nullptr)) == "Point";
  append_metadata(dataset, source);
  append_metadata(band, source);
  if (!metres.said.empty()) source.metadata.emplace_back("HEIGHTS", metres.said);

  std::array<double, 6> corner{};
  if (GDALGetGeoTransform(dataset, corner.data()) == CE_None) open.ref.to_world = centres(corner);
  open.ref.crs_wkt = crs.wkt;
  open.size = {GDALGetRasterXSize(dataset), GDALGetRasterYSize(dataset)};
  open.scale = metres.scale;
  open.offset = metres.offset;
  open.declared_nodata = declared_nodata(band);
  open.mask = mask_band(band);
  open.signed_byte = is_signed_byte(band);
  open.floats_hold_it =
      type != CellType::int32 && type != CellType::uint32 && type != CellType::float64;
  return open;
}

DemFile read_gdal(const std::string& path, const ReadOptions& options, const Run& run) {
  GdalErrors errors;
  OpenBand open = open_band(path, options, errors);
  const Size size = open.size;
  const CellType type = open.source.type;
  DemFile file;
  file.source = std::move(open.source);
  Source& source = file.source;
  file.dem.ref = open.ref;
  file.dem.z = Raster<float>(size);
  file.dem.known = Mask(size, 1);
  NodataSearch search(open.declared_nodata, "declared value", options, std::abs(open.scale));

  if (open.floats_hold_it && !open.in_other_units()) {
    read_cells(path, open.band, errors, search, file.dem.z, file.dem.known, run);
  } else {
    Raster<double> exact(size);
    read_cells(path, open.band, errors, search, exact, file.dem.known, run);
    if (open.in_other_units()) {
      const auto known = file.dem.known.cells();
      const auto values = exact.cells();
      for (std::size_t i = 0; i < values.size(); ++i)
        if (known[i]) values[i] = values[i] * open.scale + open.offset;
      if (type != CellType::float64) source.type = CellType::float32;
    }
    round_to_floats(std::move(exact), file);
    if (source.type == CellType::float32) source.exact = {};
  }
  source.nodata = search.value();
  source.evidence = search.evidence();
  turn_north_up(file);
  return file;
}

// --- Writing: cells of the file's type

GDALDataType gdal_type(CellType type) {
  switch (type) {
    case CellType::int8:
    case CellType::uint8:
      return GDT_Byte;
    case CellType::int16:
      return GDT_Int16;
    case CellType::uint16:
      return GDT_UInt16;
    case CellType::int32:
      return GDT_Int32;
    case CellType::uint32:
      return GDT_UInt32;
    case CellType::float32:
      return GDT_Float32;
    case CellType::float64:
      return GDT_Float64;
  }
  throw std::invalid_argument("unknown cell type");
}

namespace {

template <class T>
bool fits(double nodata) {
  if constexpr (std::is_floating_point_v<T>)
    return true;
  else
    return nodata == std::trunc(nodata) && nodata >= double(std::numeric_limits<T>::min()) &&
           nodata <= double(std::numeric_limits<T>::max());
}

/// No-data values to try, best first: what the source had, what is usual, for bytes any.
template <class T>
std::vector<T> nodata_candidates(std::optional<double> source) {
  std::vector<T> list;
  std::vector<double> usual{-9999, -32768, double(std::numeric_limits<T>::lowest()),
                            double(std::numeric_limits<T>::max())};
  if (std::is_same_v<T, std::int16_t>) std::swap(usual[0], usual[1]);
  if (source) usual.insert(usual.begin(), *source);
  if constexpr (sizeof(T) == 1)
    for (int v = std::numeric_limits<T>::min(); v <= std::numeric_limits<T>::max(); ++v)
      usual.push_back(v);
  for (double v : usual)
    if (fits<T>(v)) list.push_back(T(v));
  return list;
}

/// The cells of the file, and the value that means unknown (none when every value of a small type
/// is an elevation and nothing is unknown).
template <class T>
struct Cells {
  std::vector<T> values;
  std::optional<T> nodata;
};

template <class T>
Cells<T> convert(const std::string& path, const Dem& dem, const Source& source,
                 const WriteOptions& options) {
  const auto z = dem.z.cells();
  const auto known = dem.known.cells();
  const auto exact =
      source.exact.size() == dem.size() ? source.exact.cells() : std::span<const double>();
  Cells<T> cells{std::vector<T>(z.size()), {}};
  const auto fill = [&](T nodata) {
    cells.nodata = nodata;
    return to_cells<T>(path, z, exact, known, nodata, cells.values);
  };
  if (options.nodata) {
    if (!fits<T>(*options.nodata))
      throw IoError(path,
                    fmt::format("nodata {} does not fit the type, {} to {}", *options.nodata,
                                std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()));
    if (!fill(T(*options.nodata)))
      throw IoError(
          path,
          fmt::format("nodata {} is also an elevation; another must be chosen", *options.nodata),
          "out_nodata");
    return cells;
  }
  for (T nodata : nodata_candidates<T>(source.nodata))
    if (fill(nodata)) return cells;
  if (std::ranges::count(known, 0) > 0)
    throw IoError(path, "every likely nodata value is also an elevation; one must be chosen",
                  "out_nodata");
  cells.nodata.reset();
  return cells;
}

// --- Writing: what goes with them
// --------------------------------------------------------------------

void set_metadata(GDALDatasetH dataset, const Source& source, const WriteOptions& options) {
  for (const auto* list : {&source.metadata, &options.metadata})
    for (const auto& [key, value] : *list)
      GDALSetMetadataItem(dataset, key.c_str(), value.c_str(), nullptr);
  for (const CellClass& c : options.classes)
    GDALSetMetadataItem(dataset, fmt::format("CLASS_{}", c.value).c_str(), c.name.c_str(), nullptr);
  GDALSetMetadataItem(dataset, "AREA_OR_POINT", source.node_registered ? "Point" : "Area", nullptr);
}

void set_colours(GDALRasterBandH band, const std::vector<CellClass>& classes) {
  const GDALColorTableH table = GDALCreateColorTable(GPI_RGB);
  for (const CellClass& c : classes) {
    const GDALColorEntry entry{c.rgb[0], c.rgb[1], c.rgb[2], 255};
    GDALSetColorEntry(table, c.value, &entry);
  }
  GDALSetRasterColorTable(band, table);
  GDALDestroyColorTable(table);
}

}  // namespace

void set_georeference(GDALDatasetH dataset, const GeoRef& ref) {
  if (ref.to_world != GeoRef{}.to_world) {
    auto corner = corners(ref.to_world);
    GDALSetGeoTransform(dataset, corner.data());
  }
  if (!ref.crs_wkt.empty()) {
    OGRSpatialReference crs;
    crs.importFromWkt(ref.crs_wkt.c_str());
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    GDALSetSpatialRef(dataset, OGRSpatialReference::ToHandle(&crs));
  }
}

void describe_dataset(GDALDatasetH dataset, const GeoRef& ref, CellType type,
                      std::optional<double> nodata, const Source& source,
                      const WriteOptions& options) {
  const GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  set_georeference(dataset, ref);
  set_metadata(dataset, source, options);
  if (nodata) GDALSetRasterNoDataValue(band, *nodata);
  if (type == CellType::int8)
    GDALSetMetadataItem(band, "PIXELTYPE", "SIGNEDBYTE", "IMAGE_STRUCTURE");
  if (options.classes.empty())
    GDALSetRasterUnitType(band, "m");
  else
    set_colours(band, options.classes);
  if (!source.band_description.empty()) GDALSetDescription(band, source.band_description.c_str());
}

CPLStringList creation_options(const std::string& format, CellType type,
                               const WriteOptions& options, const Run& run) {
  CPLStringList list;
  const bool floating = type == CellType::float32 || type == CellType::float64;
  if (format == "GTiff" || format == "COG") {
    list.SetNameValue("BIGTIFF", "IF_SAFER");
    list.SetNameValue("NUM_THREADS", gdal_threads(run).c_str());
    list.SetNameValue("COMPRESS", options.compress ? "DEFLATE" : "NONE");
  }
  if (format == "GTiff") {
    list.SetNameValue("TILED", "YES");
    if (options.compress) list.SetNameValue("PREDICTOR", floating ? "3" : "2");
  }
  if (format == "COG" && options.compress) list.SetNameValue("PREDICTOR", "YES");
  for (const auto& [key, value] : options.creation_options)
    list.SetNameValue(key.c_str(), value.c_str());
  const std::string method = list.FetchNameValueDef("COMPRESS", "");
  const bool predicts = EQUAL(method.c_str(), "DEFLATE") || EQUAL(method.c_str(), "LZW") ||
                        EQUAL(method.c_str(), "ZSTD");
  const auto is_predictor = [](const auto& entry) {
    return EQUAL(entry.first.c_str(), "PREDICTOR") != 0;
  };
  if (!predicts && std::ranges::none_of(options.creation_options, is_predictor))
    list.SetNameValue("PREDICTOR", nullptr);
  return list;
}

void check_creation_options(const std::string& path, const std::string& format,
                            const WriteOptions& options) {
  register_gdal();
  const GDALDriverH driver = checked_driver(path, format);
  CPLStringList list;
  for (const auto& [key, value] : options.creation_options)
    list.SetNameValue(key.c_str(), value.c_str());
  if (list.empty()) return;
  CPLErrorReset();
  CPLPushErrorHandler(CPLQuietErrorHandler);
  const bool good = GDALValidateCreationOptions(driver, list.List()) != FALSE;
  const std::string cause = CPLGetLastErrorMsg();
  CPLPopErrorHandler();
  if (!good) throw IoError(path, cause);
}

GDALDriverH checked_driver(const std::string& path, const std::string& format) {
  const GDALDriverH driver = GDALGetDriverByName(format.c_str());
  if (!driver) throw IoError(path, fmt::format("there is no format \"{}\"", format));
  if (EQUAL(format.c_str(), "MEM"))
    throw IoError(path, "a MEM dataset is no file; choose another format");
  const auto can = [&](const char* what) {
    return text_or_empty(GDALGetMetadataItem(driver, what, nullptr)) == "YES";
  };
  if (!can(GDAL_DCAP_RASTER) || !(can(GDAL_DCAP_CREATECOPY) || can(GDAL_DCAP_CREATE)))
    throw IoError(path, fmt::format("the format {} cannot be written", format));
  return driver;
}

namespace {

template <class T>
void write_typed(const std::string& path, const std::string& format, CellType type, const Dem& dem,
                 const Source& source, const WriteOptions& options, const Run& run) {
  GdalErrors errors;
  const GDALDriverH driver = checked_driver(path, format);
  StagedFile staged(path, options.overwrite);
  Cells<T> cells = convert<T>(path, dem, source, options);
  const auto [cols, rows] = dem.size();
  const DatasetPtr memory = wrap_cells(cells.values.data(), cols, rows, gdal_type(type));
  describe_dataset(memory.get(), dem.ref, type,
                   cells.nodata ? std::optional(double(*cells.nodata)) : std::nullopt, source,
                   options);

  GdalProgress progress(run, "writing");
  const auto list = creation_options(GDALGetDriverShortName(driver), type, options, run);
  DatasetPtr written(GDALCreateCopy(driver, staged.path().c_str(), memory.get(), TRUE,
                                    const_cast<char**>(list.List()), GdalProgress::call,
                                    &progress));
  const bool complete = written != nullptr;
  written.reset();
  progress.rethrow();
  if (!complete || errors.any()) errors.fail(path, "cannot be written");
  staged.commit();
}

}  // namespace

void write_gdal(const std::string& path, const std::string& format, const Dem& dem,
                const Source& source, const WriteOptions& options, const Run& run) {
  const CellType type = options.type.value_or(source.type);
  with_type(type,
            [&]<class T>(T) { write_typed<T>(path, format, type, dem, source, options, run); });
}

std::string gdal_format_of(const std::string& path) {
  register_gdal();
  const std::string ext = extension(path);
  if (ext.empty()) return "";
  for (int i = 0; i < GDALGetDriverCount(); ++i) {
    const GDALDriverH driver = GDALGetDriver(i);
    const auto item = [&](const char* key) {
      return text_or_empty(GDALGetMetadataItem(driver, key, nullptr));
    };
    const bool writes = item(GDAL_DCAP_CREATECOPY) == "YES" || item(GDAL_DCAP_CREATE) == "YES";
    if (item(GDAL_DCAP_RASTER) != "YES" || !writes) continue;
    const CPLStringList extensions(CSLTokenizeString(item(GDAL_DMD_EXTENSIONS).c_str()));
    if (extensions.FindString(ext.c_str() + 1) >= 0) return GDALGetDriverShortName(driver);
  }
  return "";
}

}  // namespace dem::io
