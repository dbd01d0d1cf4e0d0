#include "fill/stream_fill.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "dem/geodesy.h"
#include "dem/polygons.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t mega = std::size_t{1} << 20;
constexpr std::size_t program_bytes = 96 * mega;  // code, libraries, small things

/// Bytes that a method takes for each cell of a window, its input and result included.
std::size_t bytes_a_cell(const FillRequest& request) {
  const std::string& name = request.method.method->name;
  const std::size_t method = name == "spline"                                  ? 110
                             : name == "mcmd" || name == "md" || name == "mdi" ? 24
                                                                               : 64;
  return method + (request.keep_sigma ? 30 : 0) + (request.rim_errors ? 10 : 0) +
         request.aux.size() * 30 + (request.water.empty() ? 0 : 4);
}

std::size_t block_cache(std::size_t memory) { return std::min(memory / 6, 256 * mega); }

/// Rows that are written at once.
int rows_at_once(int cols) {
  return std::clamp(int(mega) / std::max(cols, 1), 1, Journal::strip_rows);
}

/// Tells a journal of this run from others: whatever changes a cell, and the input's date.
std::string journal_key(const StreamFill::Options& o) {
  std::error_code error;
  const auto bytes = fs::file_size(o.in, error);
  const auto time = fs::last_write_time(o.in, error);
  return fmt::format("dem {} | {} | {} bytes, {} | {}", DEM_VERSION, o.in, error ? 0 : bytes,
                     error ? 0 : time.time_since_epoch().count(), o.settings);
}

std::string text_of_bytes(std::size_t bytes) {
  return bytes >= 1024 * mega ? fmt::format("{:.1f}G", double(bytes) / (1024. * mega))
                              : fmt::format("{}M", (bytes + mega - 1) / mega);
}

}  // namespace

std::size_t parse_memory(std::string_view option, const std::string& text) {
  constexpr auto must_be = "a size above 0, e.g. 2G, 500M";
  std::string number = text;
  double unit = 1;
  if (!number.empty()) {
    const auto at = std::string_view("kMG").find(number.back() == 'K'   ? 'k'
                                                 : number.back() == 'm' ? 'M'
                                                 : number.back() == 'g' ? 'G'
                                                                        : number.back());
    if (at != std::string_view::npos) {
      unit = std::pow(1024., double(at) + 1);
      number.pop_back();
    }
  }
  const double bytes = parse_number(option, number, must_be) * unit;
  if (!(bytes >= 1 && bytes < 1e18))
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", option, text, must_be));
  return std::size_t(bytes);
}

std::size_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  return pages > 0 && size > 0 ? std::size_t(pages) * std::size_t(size) : 4096 * mega;
}

StreamFill::StreamFill(Options options, const FillRequest& request, const Run& run)
    : options_(std::move(options)), reader_(options_.in, options_.read) {
  set_block_cache(block_cache(options_.memory));
  spacing_ = spacing_by_row(reader_.ref(), reader_.size());
  scan(request, run.part(0, 0.2));
  fill(request, run.part(0.2, 1));
}

void StreamFill::scan(const FillRequest& request, const Run& run) {
  const Size size = reader_.size();
  std::unique_ptr<Polygons> region;
  if (!request.choice.region.empty())
    region = std::make_unique<Polygons>(request.choice.region, reader_.ref());
  Mask marked;
  std::size_t known_cells = 0;
  HoleScanner scanner(size.cols, spacing_);
  reader_.scan(
      [&] {
        scanner = HoleScanner(size.cols, spacing_);
        outcome_.known_checksum = 0;
        known_cells = 0;
      },
      [&](int row, std::span<const std::uint8_t> known, std::span<const float> z) {
        const int in_strip = row % 64;
        if (region && in_strip == 0)
          marked = region->cells_in({0, row, size.cols, std::min(64, size.rows - row)});
        scanner.add_row(known, z, region ? marked.row(in_strip) : std::span<const std::uint8_t>());
        outcome_.known_checksum += known_checksum(row, known, z);
        known_cells += std::size_t(std::ranges::count_if(known, [](auto k) { return k != 0; }));
      },
      run);
  if (known_cells == 0)
    throw IoError(options_.in, "no known cell; at least one is needed to fill the others");
  outcome_.holes = scanner.finish();
}

void StreamFill::fill(const FillRequest& request, const Run& run) {
  const Size size = reader_.size();
  plan_ = plan_fill(request, outcome_.holes, size, reader_.ref(), outcome_);

  const std::size_t fixed = program_bytes + block_cache(options_.memory) + reader_.held_bytes() +
                            outcome_.holes.size() * (sizeof(Hole) + sizeof(HoleOutcome) + 128) +
                            std::size_t(size.cols) * 256 * 8 + 40 * mega;
  const std::size_t cell_bytes = bytes_a_cell(request);
  if (options_.memory < fixed + mega * cell_bytes / 4)
    throw std::invalid_argument(fmt::format("memory = {}; must be at least {} for this raster",
                                            text_of_bytes(options_.memory),
                                            text_of_bytes(fixed + mega * cell_bytes / 4)));
  const std::size_t memory_cells = (options_.memory - fixed) / cell_bytes;

  // What does not fit is left, and named.
  std::erase_if(plan_.windows, [&](const HoleWindow& window) {
    if (window.box.cells() <= memory_cells) return false;
    for (const std::uint32_t h : window.holes) {
      HoleOutcome& hole = outcome_.outcomes[h];
      hole.verdict = Verdict::memory;
      hole.left_cells = outcome_.holes[h].cells;
      outcome_.left += hole.left_cells;
    }
    outcome_.memory_needed =
        std::max(outcome_.memory_needed, fixed + window.box.cells() * cell_bytes);
    return true;
  });
  outcome_.windows = plan_.windows.size();

  fs::path out(options_.out);
  if (!out.has_filename()) out = out.parent_path();  // a folder, "tiles/"
  const std::string hidden =
      (out.parent_path() / fmt::format(".{}", out.filename().string())).string();
  journal_path_ = hidden + (options_.resume ? ".journal" : fmt::format(".{}", getpid()));
  journal_ = std::make_unique<Journal>(journal_path_, journal_key(options_));
  if (!options_.resume) fs::remove(journal_path_);  // it lives as long as it is open

  for (const HolePatch& entry : journal_->entries()) account(entry, plan_, outcome_);
  resumed_ = journal_->windows();
  std::vector<HoleWindow> windows;
  std::vector<std::size_t> numbers;
  for (std::size_t w = 0; w < plan_.windows.size(); ++w)
    if (!journal_->has(w)) {
      windows.push_back(plan_.windows[w]);
      numbers.push_back(w);
    }

  FillLayers layers(request.aux, request.water, reader_.ref());
  HoleWork work;
  work.flat_water = !plan_.whole;
  work.rim_errors = request.rim_errors;
  work.memory_cells = memory_cells;
  work.fill = [&](const Dem& window, const Run& how) {
    return request.method.method->fill(window, request.method.settings, how);
  };
  work.read = [&](const Box& box) {
    WindowData data{reader_.read(box), {}, {}};
    data.dem.spacing = spacing_[std::size_t(box.row + box.rows / 2)];
    layers.add(data, box);
    return data;
  };
  work.take = [&](HolePatch&& patch) {
    patch.window = numbers[patch.window];
    account(patch, plan_, outcome_);
    journal_->add(patch);
  };
  const auto start = std::chrono::steady_clock::now();
  fill_windows(outcome_.holes, windows, work, run);
  outcome_.aux = layers.fits();
  outcome_.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void StreamFill::overlay(const std::vector<StripPiece>& pieces, Layer layer, const Box& box,
                         Dem& rows) const {
  for (const StripPiece& piece : pieces) {
    std::size_t cell = 0;
    for (const CellRun& run : piece.runs) {
      const std::size_t first = cell;
      cell += std::size_t(run.end - run.begin);
      if (run.row < box.row || run.row >= box.row + box.rows) continue;
      for (int col = run.begin; col < run.end; ++col) {
        const std::size_t i = first + std::size_t(col - run.begin);
        if (col < box.col || col >= box.col + box.cols) continue;
        float& z = rows.z(col - box.col, run.row - box.row);
        if (layer == Layer::origin) z = float(piece.origin[i]);
        if (piece.origin[i] == CellOrigin::left) continue;
        if (layer == Layer::heights) z = piece.z[i];
        if (layer == Layer::sigma && !piece.sigma.empty()) z = piece.sigma[i];
        rows.known(col - box.col, run.row - box.row) = 1;
      }
    }
  }
}

void StreamFill::write(const std::string& path, Layer layer, const Source& source,
                       const WriteOptions& options, const Run& run) {
  const Size size = reader_.size();
  RasterWriter writer(path, size, reader_.ref(), source, options, run.part(0.8, 1));
  std::uint64_t sum = 0;
  std::vector<StripPiece> pieces;
  for (int row = 0; row < size.rows;) {
    run.report(0.8 * row / size.rows, "writing");
    if (row % Journal::strip_rows == 0) pieces = journal_->strip(row / Journal::strip_rows);
    const int next_strip = (row / Journal::strip_rows + 1) * Journal::strip_rows;
    const Box box{0, row, size.cols,
                  std::min({rows_at_once(size.cols), next_strip - row, size.rows - row})};
    Raster<double> exact;
    Dem rows = reader_.read(box, layer == Layer::heights ? &exact : nullptr);
    if (layer == Layer::heights) {
      for (int r = 0; r < box.rows; ++r)
        sum += known_checksum(row + r, rows.known.row(r), rows.z.row(r));
    } else {
      for (std::size_t i = 0; i < box.cells(); ++i) {
        const bool known = rows.known.cells()[i] != 0;
        rows.z.cells()[i] = layer == Layer::origin && !known ? float(CellOrigin::left) : 0;
        if (layer == Layer::origin) rows.known.cells()[i] = 1;
      }
    }
    overlay(pieces, layer, box, rows);
    writer.write(rows, exact);
    row += box.rows;
  }
  if (layer == Layer::heights) outcome_.known_kept = sum == outcome_.known_checksum;
  writer.commit();
}

FilledPart StreamFill::read(const Box& box) {
  FilledPart part{reader_.read(box), Raster<std::uint8_t>(box.size()), {}};
  Dem origin{Raster<float>(box.size()), Mask(box.size()), {}, {}}, sigma = origin;
  for (std::size_t i = 0; i < box.cells(); ++i)
    origin.z.cells()[i] =
        float(part.dem.known.cells()[i] ? CellOrigin::measured : CellOrigin::left);
  const int last = (box.row + box.rows - 1) / Journal::strip_rows;
  for (int strip = box.row / Journal::strip_rows; strip <= last; ++strip) {
    const auto pieces = journal_->strip(strip);
    overlay(pieces, Layer::heights, box, part.dem);
    overlay(pieces, Layer::origin, box, origin);
    overlay(pieces, Layer::sigma, box, sigma);
  }
  std::ranges::transform(origin.z.cells(), part.origin.cells().begin(),
                         [](float kind) { return std::uint8_t(kind); });
  part.sigma = std::move(sigma.z);
  return part;
}

void StreamFill::finish() {
  journal_.reset();
  std::error_code none;
  fs::remove(journal_path_, none);
}

}  // namespace dem::app
