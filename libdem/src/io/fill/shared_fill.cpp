#include "dem/io/shared_fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "dem/io/fill_job.h"
#include "dem/io/geodesy.h"
#include "io/fill/bytes.h"
#include "io/fill/fill_memory.h"
#include "io/fill/journal.h"

namespace dem {
using namespace io;
namespace fs = std::filesystem;

WindowRange windows_of_task(const std::vector<HoleWindow>& windows, std::size_t task,
                            std::size_t tasks) {
  std::size_t all = 0;
  for (const HoleWindow& window : windows) all += window.box.cells();
  // A window belongs to the task in whose share of the cells its middle lies.
  const auto first_of = [&](std::size_t t) {
    std::size_t before = 0, w = 0;
    for (; w < windows.size(); ++w) {
      const std::size_t cells = windows[w].box.cells();
      if (double(before) + double(cells) / 2 >= double(all) * double(t) / double(tasks)) break;
      before += cells;
    }
    return w;
  };
  return {first_of(task), task + 1 == tasks ? windows.size() : first_of(task + 1)};
}

std::vector<FillPlan> bundles_of(const FillPlan& plan, std::size_t cells) {
  std::vector<FillPlan> bundles;
  std::size_t in_last = cells;
  for (const HoleWindow& window : plan.windows) {
    if (in_last >= cells) {
      bundles.push_back({{}, {}, {}, plan.whole});
      in_last = 0;
    }
    FillPlan& bundle = bundles.back();
    HoleWindow& mine = bundle.windows.emplace_back(HoleWindow{window.box, {}});
    for (const std::uint32_t h : window.holes) {
      mine.holes.push_back(std::uint32_t(bundle.holes.size()));
      bundle.holes.push_back(plan.holes[h]);
      bundle.verdicts.push_back(plan.verdicts[h]);
    }
    in_last += window.box.cells();
  }
  return bundles;
}

std::string bytes_of(const FillPlan& plan) {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> numbers, counts;
  for (const HoleWindow& window : plan.windows) {
    boxes.push_back(window.box);
    counts.push_back(std::uint32_t(window.holes.size()));
    numbers.insert(numbers.end(), window.holes.begin(), window.holes.end());
  }
  std::string out;
  put(out, plan.holes);
  put(out, plan.verdicts);
  put(out, boxes);
  put(out, counts);
  put(out, numbers);
  put(out, std::vector<std::uint8_t>{plan.whole});
  return out;
}

FillPlan plan_from_bytes(std::string_view bytes) {
  FillPlan plan;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> numbers, counts;
  std::vector<std::uint8_t> whole;
  Taker taker(bytes);
  taker.take(plan.holes);
  taker.take(plan.verdicts);
  taker.take(boxes);
  taker.take(counts);
  taker.take(numbers);
  taker.take(whole);
  auto number = numbers.begin();
  for (std::size_t w = 0; w < boxes.size(); ++w) {
    plan.windows.push_back({boxes[w], {number, number + counts.at(w)}});
    number += counts[w];
  }
  plan.whole = whole.at(0) != 0;
  return plan;
}

std::string bytes_of(const HolePart& part) {
  std::string out;
  put(out, part.holes);
  put(out, part.runs);
  put(out, part.rim);
  put(out, std::vector<std::size_t>{part.known_cells});
  return out;
}

HolePart part_from_bytes(std::string_view bytes) {
  HolePart part;
  std::vector<std::size_t> known;
  Taker taker(bytes);
  taker.take(part.holes);
  taker.take(part.runs);
  taker.take(part.rim);
  taker.take(known);
  part.known_cells = known.at(0);
  return part;
}

SharedFill::SharedFill(const std::string& path, const ReadOptions& read, const FillOptions& options,
                       FillFiles files, std::size_t memory)
    : reader_(path, read),
      options_(checked(options)),
      files_(std::move(files)),
      memory_(memory),
      spacing_(spacing_by_row(reader_.ref(), reader_.size())) {
  if (!files_.region.empty())
    throw std::invalid_argument(
        fmt::format("region = {}; a raster that many processes fill takes none", files_.region));
  set_block_cache(block_cache(memory_));
  check_memory(0, "a worker by itself");
}

void SharedFill::check_memory(std::size_t bytes, const std::string& what) const {
  const std::size_t needed = program_bytes + block_cache(memory_) + bytes;
  if (needed > memory_)
    throw std::invalid_argument(fmt::format("memory = {}; must be at least {}: {}",
                                            text_of_bytes(memory_), text_of_bytes(needed), what));
}

HolePart SharedFill::scan(const Box& part) {
  const Box ring = with_ring(part, size());
  check_memory(ring.cells() * 8, fmt::format("a part of {} cells is read", ring.cells()));
  return scan_part(reader_.read(ring), part, size(), spacing_);
}

FillPlan SharedFill::plan(const std::vector<HolePart>& parts) const {
  std::size_t known = 0;
  for (const HolePart& part : parts) known += part.known_cells;
  if (known == 0)
    throw std::invalid_argument("no cell is known; at least one is needed to fill the others");
  FillPlan plan = plan_fill(join_parts(parts, size(), spacing_), size(), lattice_origin(ref()),
                            options_, false);
  std::size_t largest = 0, unknown = 0;
  for (const HoleWindow& window : plan.windows) largest = std::max(largest, window.box.cells());
  for (const Hole& hole : plan.holes) unknown += hole.cells;
  check_memory(largest * bytes_a_cell(options_, files_),
               plan.whole ? fmt::format("{} of {} cells are unknown, so all are one problem; "
                                        "inner_only, max_area_km2 or where would leave the sea out",
                                        unknown, size().cells())
                          : fmt::format("the largest void has a window of {} cells; max_area_km2, "
                                        "inner_only or where would leave it out",
                                        largest));
  return plan;
}

FillReport SharedFill::fill(const FillPlan& bundle, const std::string& path, const std::string& key,
                            const Run& run) {
  const bool was_whole = fs::exists(path);
  const std::string unfinished = was_whole ? path : path + ".part";
  Journal journal(unfinished, key);
  const std::size_t cells = std::max<std::size_t>(
      1, (memory_ - program_bytes - block_cache(memory_)) / bytes_a_cell(options_, files_));
  FillReport report = fill_plan(raster_of(reader_, spacing_), bundle, {}, options_,
                                open_layers(files_, ref()), journal, cells, run);
  if (!was_whole) fs::rename(unfinished, path);
  return report;
}

std::size_t SharedFill::write_tile(const std::string& tile, const Box& box,
                                   const std::vector<std::string>& journals, const std::string& key,
                                   const std::string& out, const WriteOptions& options,
                                   const Run& run) {
  check_memory(box.cells() * 24, fmt::format("{} has {} cells", tile, box.cells()));
  ReadOptions as_declared;
  as_declared.detect_nodata = false;
  DemFile file = read_dem(tile, as_declared, run.part(0, 0.3));
  if (file.dem.size() != box.size())
    throw IoError(tile, fmt::format("is {} x {} cells; was {} x {} when the run began",
                                    file.dem.z.cols(), file.dem.z.rows(), box.cols, box.rows));
  Dem rows = reader_.read(box);
  for (const std::string& path : journals) {
    if (!fs::exists(path)) throw IoError(path, "journal: is not there any more");
    Journal journal(path, key, Journal::Access::read);
    for (int strip = box.row / Journal::strip_rows;
         strip <= (box.row + box.rows - 1) / Journal::strip_rows; ++strip)
      overlay(journal.strip(strip), FillLayer::heights, box, rows);
  }
  file.dem.z = std::move(rows.z);
  file.dem.known = std::move(rows.known);
  write_dem(out, file.dem, file.source, options, run.part(0.5, 1));
  return box.cells() - count(file.dem.known);
}

}  // namespace dem
