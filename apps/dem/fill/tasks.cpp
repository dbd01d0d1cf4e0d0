#include "fill/tasks.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "dem/io/geodesy.h"
#include "fill/bytes.h"
#include "fill/fill_layers.h"
#include "fill/stream_fill.h"

namespace dem::app {
namespace fs = std::filesystem;

std::pair<std::size_t, std::size_t> windows_of_task(const std::vector<HoleWindow>& windows,
                                                    std::size_t task, std::size_t tasks) {
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

std::string Bundle::bytes() const {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> numbers, counts;
  for (const HoleWindow& window : windows) {
    boxes.push_back(window.box);
    counts.push_back(std::uint32_t(window.holes.size()));
    numbers.insert(numbers.end(), window.holes.begin(), window.holes.end());
  }
  std::string out;
  put(out, holes);
  put(out, boxes);
  put(out, counts);
  put(out, numbers);
  put(out, std::vector<std::uint8_t>{whole});
  return out;
}

Bundle Bundle::from_bytes(std::string_view bytes) {
  Bundle bundle;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> numbers, counts;
  std::vector<std::uint8_t> whole;
  Taker taker(bytes);
  taker.take(bundle.holes);
  taker.take(boxes);
  taker.take(counts);
  taker.take(numbers);
  taker.take(whole);
  auto number = numbers.begin();
  for (std::size_t w = 0; w < boxes.size(); ++w) {
    bundle.windows.push_back({boxes[w], {number, number + counts[w]}});
    number += counts[w];
  }
  bundle.whole = whole.at(0) != 0;
  return bundle;
}

std::vector<Bundle> make_bundles(const FillPlan& plan, const std::vector<Hole>& holes,
                                 std::size_t cells) {
  std::vector<Bundle> bundles;
  std::size_t in_last = cells;
  for (const HoleWindow& window : plan.windows) {
    if (in_last >= cells) {
      bundles.push_back({{}, {}, plan.whole});
      in_last = 0;
    }
    Bundle& bundle = bundles.back();
    HoleWindow& mine = bundle.windows.emplace_back(HoleWindow{window.box, {}});
    for (const std::uint32_t h : window.holes) {
      mine.holes.push_back(std::uint32_t(bundle.holes.size()));
      bundle.holes.push_back(holes[h]);
    }
    in_last += window.box.cells();
  }
  return bundles;
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

SharedRaster::SharedRaster(const std::string& path, const ReadOptions& read, FillRequest request,
                           std::size_t memory)
    : reader_(path, read),
      request_(std::move(request)),
      memory_(memory),
      spacing_(spacing_by_row(reader_.ref(), reader_.size())) {
  set_block_cache(block_cache(memory_));
  check_memory(0, "a worker by itself");
}

void SharedRaster::check_memory(std::size_t bytes, const std::string& what) const {
  const std::size_t needed = program_bytes + block_cache(memory_) + bytes;
  if (needed > memory_)
    throw std::invalid_argument(fmt::format("memory = {}; must be at least {}: {}",
                                            text_of_bytes(memory_), text_of_bytes(needed), what));
}

HolePart SharedRaster::scan(const Box& part) {
  const Box ring = with_ring(part, size());
  check_memory(ring.cells() * 8, fmt::format("a part of {} cells is read", grouped(ring.cells())));
  return scan_part(reader_.read(ring), part, size(), spacing_);
}

FillPlan SharedRaster::plan(const std::vector<HolePart>& parts, std::vector<Hole>& holes,
                            FillOutcome& outcome) const {
  std::size_t known = 0;
  for (const HolePart& part : parts) known += part.known_cells;
  if (known == 0)
    throw std::invalid_argument("no cell is known; at least one is needed to fill the others");
  holes = join_parts(parts, size(), spacing_);
  FillPlan plan = plan_fill(request_, holes, size(), ref(), outcome);
  std::size_t largest = 0;
  for (const HoleWindow& window : plan.windows) largest = std::max(largest, window.box.cells());
  check_memory(largest * bytes_a_cell(request_),
               plan.whole ? fmt::format("{} of {} cells are unknown, so all are one problem; "
                                        "inner_only, max_area_km2 or where would leave the sea out",
                                        grouped(outcome.unknown), grouped(size().cells()))
                          : fmt::format("the largest hole has a window of {} cells; max_area_km2, "
                                        "inner_only or where would leave it out",
                                        grouped(largest)));
  return plan;
}

BundleOutcome SharedRaster::fill(const Bundle& bundle, const std::string& path,
                                 const std::string& key, const Run& run) {
  const bool was_whole = fs::exists(path);
  const std::string unfinished = was_whole ? path : path + ".part";
  Journal journal(unfinished, key);
  BundleOutcome out;
  FillOutcome sums;
  FillPlan plan{{}, bundle.windows, bundle.whole};
  sums.outcomes.resize(bundle.holes.size());
  for (const HolePatch& entry : journal.entries()) account(entry, plan, sums);
  out.resumed = journal.windows();

  std::vector<HoleWindow> windows;
  std::vector<std::size_t> numbers;
  for (std::size_t w = 0; w < bundle.windows.size(); ++w)
    if (!journal.has(w)) {
      windows.push_back(bundle.windows[w]);
      numbers.push_back(w);
    }
  FillLayers layers(request_.aux, request_.water, ref());
  HoleWork work;
  work.flat_water = !bundle.whole;
  work.memory_cells = std::max<std::size_t>(
      1, (memory_ - program_bytes - block_cache(memory_)) / bytes_a_cell(request_));
  work.fill = filler(request_.method);
  work.read = [&](const Box& box) {
    WindowData data{reader_.read(box), {}, {}};
    data.dem.spacing = spacing_[std::size_t(box.row + box.rows / 2)];
    layers.add(data, box);
    return data;
  };
  work.take = [&](HolePatch&& patch) {
    patch.window = numbers[patch.window];
    account(patch, plan, sums);
    out.seconds += patch.seconds;
    journal.add(patch);
  };
  fill_windows(bundle.holes, windows, work, run);
  if (!was_whole) fs::rename(unfinished, path);
  out.windows = bundle.windows.size();
  out.filled = sums.filled;
  out.left = sums.left;
  out.water = sums.water_cells;
  out.over_aux = sums.guide_cells;
  return out;
}

std::size_t SharedRaster::write_tile(const std::string& tile, const Box& box,
                                     const std::vector<std::string>& journals,
                                     const std::string& key, const std::string& out,
                                     const WriteOptions& options, const Run& run) {
  check_memory(box.cells() * 24, fmt::format("{} has {} cells", tile, grouped(box.cells())));
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
      overlay(journal.strip(strip), Layer::heights, box, rows);
  }
  file.dem.z = std::move(rows.z);
  file.dem.known = std::move(rows.known);
  write_dem(out, file.dem, file.source, options, run.part(0.5, 1));
  return box.cells() - count(file.dem.known);
}

}  // namespace dem::app
