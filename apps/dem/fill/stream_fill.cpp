#include "fill/stream_fill.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "dem/io/geodesy.h"
#include "dem/io/polygons.h"
#include "fill/tasks.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t mega = std::size_t{1} << 20;

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

}  // namespace

std::size_t bytes_a_cell(const FillRequest& request) {
  return request.method.method->traits.bytes_per_cell.value + (request.keep_sigma ? 30 : 0) +
         (request.rim_errors ? 10 : 0) + request.aux.size() * 30 + (request.water.empty() ? 0 : 4);
}

std::size_t block_cache(std::size_t memory) { return std::min(memory / 6, 256 * mega); }

std::string text_of_bytes(std::size_t bytes) {
  return bytes >= 1024 * mega ? fmt::format("{:.1f}G", double(bytes) / (1024. * mega))
                              : fmt::format("{}M", (bytes + mega - 1) / mega);
}

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

  open_journals();
  for (const auto& journal : journals_)
    for (const HolePatch& entry : journal->entries()) account(entry, plan_, outcome_);
  const auto [first, last] = options_.tasks
                                 ? windows_of_task(plan_.windows, std::size_t(options_.task) - 1,
                                                   std::size_t(options_.tasks))
                                 : std::pair{std::size_t{0}, plan_.windows.size()};
  std::vector<HoleWindow> windows;
  std::vector<std::size_t> numbers;
  for (std::size_t w = first; w < last; ++w)
    if (is_done(w)) {
      ++resumed_;
    } else {
      windows.push_back(plan_.windows[w]);
      numbers.push_back(w);
    }
  if (options_.tasks) outcome_.windows = last - first;

  FillLayers layers(request.aux, request.water, reader_.ref());
  HoleWork work;
  work.flat_water = !plan_.whole;
  work.rim_errors = request.rim_errors;
  work.memory_cells = memory_cells;
  work.fill = filler(request.method);
  work.read = [&](const Box& box) {
    WindowData data{reader_.read(box), {}, {}};
    data.dem.spacing = spacing_[std::size_t(box.row + box.rows / 2)];
    layers.add(data, box);
    return data;
  };
  work.take = [&](HolePatch&& patch) {
    patch.window = numbers[patch.window];
    account(patch, plan_, outcome_);
    journals_[0]->add(patch);
  };
  const auto start = std::chrono::steady_clock::now();
  fill_windows(outcome_.holes, windows, work, run);
  outcome_.aux = layers.fits();
  outcome_.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void StreamFill::write(const std::string& path, Layer layer, const Source& source,
                       const WriteOptions& options, const Run& run) {
  const Size size = reader_.size();
  RasterWriter writer(path, size, reader_.ref(), source, options, run.part(0.8, 1));
  std::uint64_t sum = 0;
  std::vector<StripPiece> pieces;
  for (int row = 0; row < size.rows;) {
    run.report(0.8 * row / size.rows, "writing");
    if (row % Journal::strip_rows == 0) {
      pieces.clear();
      for (const auto& journal : journals_)
        std::ranges::move(journal->strip(row / Journal::strip_rows), std::back_inserter(pieces));
    }
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
    for (const auto& journal : journals_) {
      const auto pieces = journal->strip(strip);
      overlay(pieces, Layer::heights, box, part.dem);
      overlay(pieces, Layer::origin, box, origin);
      overlay(pieces, Layer::sigma, box, sigma);
    }
  }
  std::ranges::transform(origin.z.cells(), part.origin.cells().begin(),
                         [](float kind) { return std::uint8_t(kind); });
  part.sigma = std::move(sigma.z);
  return part;
}

/// Its own journal, a hidden file beside the output: ".out.tif.journal", or ".out.tif.journal.2of8" of
/// a task. Without --resume it lives as long as it is open.
void StreamFill::open_journals() {
  fs::path out(options_.out);
  if (!out.has_filename()) out = out.parent_path();  // a folder, "tiles/"
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const std::string name = fmt::format(".{}.journal", out.filename().string());
  const std::string own =
      options_.tasks    ? fmt::format("{}.{}of{}", name, options_.task, options_.tasks)
      : options_.resume ? name
                        : fmt::format(".{}.{}", out.filename().string(), getpid());
  // Windows go by their numbers, so all must have left the same ones out for their size.
  std::size_t cells = 0;
  for (const HoleWindow& window : plan_.windows) cells += window.box.cells();
  const std::string key = fmt::format("{} | {} windows of {} cells", journal_key(options_),
                                      plan_.windows.size(), cells);
  journal_paths_ = {(folder / own).string()};
  journals_.push_back(std::make_unique<Journal>(journal_paths_[0], key));
  if (!options_.tasks && !options_.resume) fs::remove(journal_paths_[0]);
  if (options_.tasks || !options_.resume) return;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().starts_with(name + "."))
      journal_paths_.push_back(entry.path().string());
  std::ranges::sort(journal_paths_.begin() + 1, journal_paths_.end());
  for (std::size_t i = 1; i < journal_paths_.size(); ++i)
    journals_.push_back(std::make_unique<Journal>(journal_paths_[i], key, Journal::Access::read));
}

bool StreamFill::is_done(std::size_t window) const {
  return std::ranges::any_of(journals_, [&](const auto& journal) { return journal->has(window); });
}

void StreamFill::finish() {
  journals_.clear();
  std::error_code none;
  for (const std::string& path : journal_paths_) fs::remove(path, none);
}

}  // namespace dem::app
