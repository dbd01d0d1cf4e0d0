#include "dem/io/fill_job.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "dem/io/geodesy.h"
#include "dem/io/shared_fill.h"
#include "io/fill/fill_memory.h"
#include "io/fill/journal.h"

namespace dem {
using namespace io;
namespace fs = std::filesystem;

/// A raster in memory, which fill_holes fills in place.
struct FillJob::Held {
  HoleFill filled;  // its Dem is the raster from the beginning
  Source source;

  void write(const std::string& path, FillLayer layer, const Source& of,
             const WriteOptions& options, const Run& run) const;
  FilledPart read(const Box& box) const;
};

/// A raster on disk, and the journals of its windows.
struct FillJob::Streamed {
  RasterReader reader;
  std::vector<Spacing> spacing;
  FillPlan plan{};
  FillReport report{};
  std::vector<std::string> journal_paths{};
  Journals journals{};

  void scan(const FillJob::Options& options, const FillLayers& layers, const std::string& in,
            const Run& run);
  std::size_t memory_cells(const FillJob::Options& options) const;
  std::size_t fixed_bytes(const FillJob::Options& options) const;
  void leave_out_large(const FillJob::Options& options, std::size_t memory_cells);
  void open_journals(const FillJob::Options& options, const std::string& in);
  void write(const std::string& path, FillLayer layer, const Source& source,
             const WriteOptions& options, const Run& run);
  FilledPart read(const Box& box);
};

namespace {

/// Number of rows that are written at once.
int rows_at_once(int cols) {
  return std::clamp(int(mega) / std::max(cols, 1), 1, Journal::strip_rows);
}

/// Tells the journal of this run from others: whatever changes a cell, and the input's date.
std::string journal_key(const std::string& in, const FillJob::Options& o) {
  std::error_code error;
  const auto bytes = fs::file_size(in, error);
  const auto time = fs::last_write_time(in, error);
  std::string key =
      fmt::format("dem {} | {} | {} bytes, {} | {}", DEM_VERSION, in, error ? 0 : bytes,
                  error ? 0 : time.time_since_epoch().count(), o.fill.method.method->name);
  for (const auto& [name, value] : o.fill.method.settings)
    key += fmt::format(" {}={}", name, value);
  return key + fmt::format(" | {} | {} {} {} | {} | {} | {} | {}", text_of(o.fill.holes),
                           o.fill.whole, o.fill.sigma, o.fill.rim_errors, o.memory, o.files.water,
                           o.files.region, fmt::join(o.files.aux, " "));
}

/// Cells that a layer has where no window was filled.
void clear_layer(Dem& rows, FillLayer layer) {
  for (std::size_t i = 0; i < rows.known.cells().size(); ++i) {
    const bool known = rows.known.cells()[i] != 0;
    rows.z.cells()[i] = layer == FillLayer::origin && !known ? float(CellOrigin::left) : 0;
    if (layer == FillLayer::origin) rows.known.cells()[i] = 1;
  }
}

}  // namespace

// ---- In memory

void FillJob::Held::write(const std::string& path, FillLayer layer, const Source& of,
                          const WriteOptions& options, const Run& run) const {
  if (layer == FillLayer::heights) return write_dem(path, filled.dem, of, options, run);
  Dem layer_dem{Raster<float>(filled.dem.size()), Mask(filled.dem.size(), 1), filled.dem.ref,
                filled.dem.spacing};
  if (layer == FillLayer::sigma) {
    layer_dem.z = filled.sigma;
    layer_dem.known = filled.dem.known;
  } else {
    std::ranges::copy(filled.origin.cells(), layer_dem.z.cells().begin());
  }
  write_dem(path, layer_dem, of, options, run);
}

FilledPart FillJob::Held::read(const Box& box) const {
  return {crop(filled.dem, box, filled.dem.spacing), crop(filled.origin, box),
          filled.sigma.empty() ? Raster<float>() : crop(filled.sigma, box)};
}

// ---- On disk

void FillJob::Streamed::scan(const Options& options, const FillLayers& layers,
                             const std::string& in, const Run& run) {
  constexpr int strip = 64;
  const Size size = reader.size();
  Mask marked;
  std::size_t known_cells = 0;
  std::uint64_t checksum = 0;
  HoleScanner scanner(size.cols, spacing);
  reader.scan(
      [&] {
        scanner = HoleScanner(size.cols, spacing);
        checksum = 0;
        known_cells = 0;
      },
      [&](int row, std::span<const std::uint8_t> known, std::span<const float> z) {
        const int in_strip = row % strip;
        if (layers.region && in_strip == 0)
          marked = layers.region({0, row, size.cols, std::min(strip, size.rows - row)});
        scanner.add_row(known, z,
                        marked.empty() ? std::span<const std::uint8_t>() : marked.row(in_strip));
        checksum += known_checksum(row, known, z);
        known_cells += std::size_t(std::ranges::count_if(known, [](auto k) { return k != 0; }));
      },
      run);
  if (known_cells == 0)
    throw IoError(in, "no known cell; at least one is needed to fill the others");
  plan = plan_fill(scanner.finish(), size, lattice_origin(reader.ref()), options.fill,
                   bool(layers.region));
  report.known_checksum = checksum;
}

std::size_t FillJob::Streamed::fixed_bytes(const Options& options) const {
  return program_bytes + block_cache(options.memory) + reader.held_bytes() +
         plan.holes.size() * (sizeof(Hole) + sizeof(HoleOutcome) + 128) +
         std::size_t(reader.size().cols) * 256 * 8 + 40 * mega;
}

/// Cells of windows that may be worked on at once.
std::size_t FillJob::Streamed::memory_cells(const Options& options) const {
  const std::size_t cell = bytes_a_cell(options.fill, options.files);
  const std::size_t least = fixed_bytes(options) + mega * cell / 4;
  if (options.memory < least)
    throw std::invalid_argument(fmt::format("memory = {}; must be at least {} for this raster",
                                            text_of_bytes(options.memory), text_of_bytes(least)));
  return (options.memory - fixed_bytes(options)) / cell;
}

/// Voids whose window does not fit are left, and named.
void FillJob::Streamed::leave_out_large(const Options& options, std::size_t memory_cells) {
  std::erase_if(plan.windows, [&](const HoleWindow& window) {
    if (window.box.cells() <= memory_cells) return false;
    for (const std::uint32_t h : window.holes) plan.verdicts[h] = Verdict::memory;
    report.memory_needed = std::max(
        report.memory_needed,
        fixed_bytes(options) + window.box.cells() * bytes_a_cell(options.fill, options.files));
    return true;
  });
}

/// Its own journal, a hidden file beside the output: ".out.tif.journal", or ".out.tif.journal.2of8"
/// of a task. Without `resume` it lives as long as it is open.
void FillJob::Streamed::open_journals(const Options& options, const std::string& in) {
  fs::path out(options.out);
  if (!out.has_filename()) out = out.parent_path();  // a folder, "tiles/"
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const std::string name = fmt::format(".{}.journal", out.filename().string());
  const std::string own =
      options.tasks    ? fmt::format("{}.{}of{}", name, options.task, options.tasks)
      : options.resume ? name
                       : fmt::format(".{}.{}", out.filename().string(), getpid());
  // Windows go by their numbers, so all must have left the same ones out for their size.
  std::size_t cells = 0;
  for (const HoleWindow& window : plan.windows) cells += window.box.cells();
  const std::string key = fmt::format("{} | {} windows of {} cells", journal_key(in, options),
                                      plan.windows.size(), cells);
  journal_paths = {(folder / own).string()};
  journals.open(journal_paths[0], key, Journal::Access::write);
  if (!options.tasks && !options.resume) fs::remove(journal_paths[0]);
  if (options.tasks || !options.resume) return;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().starts_with(name + "."))
      journal_paths.push_back(entry.path().string());
  std::ranges::sort(journal_paths.begin() + 1, journal_paths.end());
  for (std::size_t i = 1; i < journal_paths.size(); ++i)
    journals.open(journal_paths[i], key, Journal::Access::read);
}

void FillJob::Streamed::write(const std::string& path, FillLayer layer, const Source& source,
                              const WriteOptions& options, const Run& run) {
  const Size size = reader.size();
  RasterWriter writer(path, size, reader.ref(), source, options, run.part(0.8, 1));
  std::uint64_t sum = 0;
  std::vector<StripPiece> pieces;
  for (int row = 0; row < size.rows;) {
    run.report(0.8 * row / size.rows, "writing");
    if (row % Journal::strip_rows == 0) pieces = journals.strip(row / Journal::strip_rows);
    const int next_strip = (row / Journal::strip_rows + 1) * Journal::strip_rows;
    const Box box{0, row, size.cols,
                  std::min({rows_at_once(size.cols), next_strip - row, size.rows - row})};
    Raster<double> exact;
    Dem rows = reader.read(box, layer == FillLayer::heights ? &exact : nullptr);
    if (layer == FillLayer::heights) {
      for (int r = 0; r < box.rows; ++r)
        sum += known_checksum(row + r, rows.known.row(r), rows.z.row(r));
    } else {
      clear_layer(rows, layer);
    }
    overlay(pieces, layer, box, rows);
    writer.write(rows, exact);
    row += box.rows;
  }
  if (layer == FillLayer::heights) report.known_kept = sum == report.known_checksum;
  writer.commit();
}

FilledPart FillJob::Streamed::read(const Box& box) {
  FilledPart part{reader.read(box), Raster<std::uint8_t>(box.size()), {}};
  Dem origin{Raster<float>(box.size()), Mask(box.size()), {}, {}}, sigma = origin;
  for (std::size_t i = 0; i < box.cells(); ++i)
    origin.z.cells()[i] =
        float(part.dem.known.cells()[i] ? CellOrigin::measured : CellOrigin::left);
  const int last = (box.row + box.rows - 1) / Journal::strip_rows;
  for (int strip = box.row / Journal::strip_rows; strip <= last; ++strip) {
    const auto pieces = journals.strip(strip);
    overlay(pieces, FillLayer::heights, box, part.dem);
    overlay(pieces, FillLayer::origin, box, origin);
    overlay(pieces, FillLayer::sigma, box, sigma);
  }
  std::ranges::transform(origin.z.cells(), part.origin.cells().begin(),
                         [](float kind) { return std::uint8_t(kind); });
  part.sigma = std::move(sigma.z);
  return part;
}

// ---- The job

FillJob::FillJob(const std::string& in, Options options, const Run& run)
    : in_(in), options_(std::move(options)) {
  if (options_.tasks && options_.resume)
    throw std::invalid_argument("resume = true; a task goes on by itself where it was stopped");
  options_.fill = checked(std::move(options_.fill));
  if (options_.memory == 0 && (options_.resume || options_.tasks))
    options_.memory = machine_memory() / 2;
  if (options_.memory > 0) {
    streamed_.reset(new Streamed{{in, options_.read}, {}});
    streamed_->spacing = spacing_by_row(streamed_->reader.ref(), streamed_->reader.size());
    set_block_cache(block_cache(options_.memory));
    return;
  }
  DemFile file = read_dem(in, options_.read, run);
  if (count(file.dem.known) == 0)
    throw IoError(in, "no known cell; at least one is needed to fill the others");
  held_ = std::make_unique<Held>();
  held_->filled.dem = std::move(file.dem);
  held_->source = std::move(file.source);
}

FillJob::~FillJob() = default;

Size FillJob::size() const { return held_ ? held_->filled.dem.size() : streamed_->reader.size(); }

const GeoRef& FillJob::ref() const {
  return held_ ? held_->filled.dem.ref : streamed_->reader.ref();
}

const Source& FillJob::source() const { return held_ ? held_->source : streamed_->reader.source(); }

const Dem* FillJob::held() const { return held_ ? &held_->filled.dem : nullptr; }

const FillPlan& FillJob::plan() const { return held_ ? held_->filled.plan : streamed_->plan; }

const FillReport& FillJob::report() const {
  return held_ ? held_->filled.report : streamed_->report;
}

void FillJob::fill(const Run& run) {
  const FillLayers layers = open_layers(options_.files, ref());
  if (held_) {
    held_->filled = fill_holes(std::move(held_->filled.dem), options_.fill, layers, run);
    return;
  }
  Streamed& s = *streamed_;
  s.scan(options_, layers, in_, run.part(0, 0.2));
  const std::size_t cells = s.memory_cells(options_);
  s.leave_out_large(options_, cells);
  s.open_journals(options_, in_);
  const WindowRange range = options_.tasks
                                ? windows_of_task(s.plan.windows, std::size_t(options_.task) - 1,
                                                  std::size_t(options_.tasks))
                                : WindowRange{};
  FillReport report = fill_plan(raster_of(s.reader, s.spacing), s.plan, range, options_.fill,
                                layers, s.journals, cells, run.part(0.2, 1));
  report.known_checksum = s.report.known_checksum;
  report.memory_needed = s.report.memory_needed;
  s.report = std::move(report);
}

void FillJob::write(const std::string& path, FillLayer layer, const Source& source,
                    const WriteOptions& options, const Run& run) {
  if (held_) {
    held_->write(path, layer, source, options, run);
  } else {
    streamed_->write(path, layer, source, options, run);
  }
}

FilledPart FillJob::read(const Box& box) { return held_ ? held_->read(box) : streamed_->read(box); }

void FillJob::finish() {
  if (held_) return;
  streamed_->journals.close();
  std::error_code none;
  for (const std::string& path : streamed_->journal_paths) fs::remove(path, none);
}

}  // namespace dem
