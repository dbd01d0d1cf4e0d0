// Speed, memory and error of every fill method and preset, on one thread:
//
//   fill/METHOD/SIZE/PERCENT    SIZE: cells along a side; PERCENT: share of the cells that is kept
//
//   ns_per_cell     CPU time over all cells of the raster, in memory that the process has already:
//                   a first call also waits for its pages, 0.3 to 0.7 ns a byte on some machines
//   bytes_per_cell  peak memory of one call beyond the DEM it gets and the raster it returns
//   rmse_m          over the removed cells, so that speed cannot be bought with error
//
// 1025 is Mount Washington when DEM_TESTDATA says where its tile is, else a fractal; 4097 and 16385
// are fractals. Example:
//   build/release/tests/bench/fill_bench --benchmark_filter='fill/mcmd/1025/.*'

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "dem/evaluate.h"
#include "dem/io/methods.h"
#include "dem/io/rasters.h"
#include "dem/mcmd.h"
#include "dem/sample.h"

namespace {

const dem::Run one_thread{.threads = 1, .progress = {}};

/// Terrain from nothing: the noise of midpoint displacement, with about the roughness of mountains.
dem::Dem fractal(int side) {
  dem::Dem dem{.z = dem::Raster<float>({side, side}),
               .known = dem::Mask({side, side}),
               .ref = {},
               .spacing = {30, 30}};
  dem.z = dem::fill_md(dem, {.H = 0, .rs = 0.5, .seed = 7}, one_thread);
  dem.known = dem::Mask({side, side}, 1);
  return dem;
}

std::string mount_washington() {
  const char* folder = std::getenv("DEM_TESTDATA");
  return folder ? std::string(folder) + "/mtwashington_1025_3s.tif" : "";
}

/// The whole DEM of one size, made once.
const dem::Dem& truth(int side) {
  static std::map<int, dem::Dem> made;
  auto found = made.find(side);
  if (found == made.end()) {
    const std::string tile = side == 1025 ? mount_washington() : "";
    found = made.emplace(side, tile.empty() ? fractal(side) : dem::read_dem(tile).dem).first;
  }
  return found->second;
}

dem::Mask removed_cells(const dem::Dem& whole, const dem::Dem& problem) {
  dem::Mask removed(whole.size());
  for (std::size_t i = 0; i < removed.cells().size(); ++i)
    removed.cells()[i] = whole.known.cells()[i] && !problem.known.cells()[i];
  return removed;
}

/// A line of /proc/self/status in bytes, e.g. "VmHWM:".
double memory(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kibibytes = 0; word == name && status >> kibibytes) return kibibytes * 1024;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Blocks of memory come from the kernel and go back to it at once: a call's peak is its own.
void return_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  mallopt(M_MMAP_MAX, 1 << 16);
  malloc_trim(0);
}

/// What is freed stays with the process and is used again.
void keep_memory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TOP_PAD, 1 << 26);
}

/// Peak of resident memory during `work()`, beyond what was resident before. The kernel's own count
/// sees the memory of every library, unlike a counting operator new, and costs no time. NaN where
/// the kernel does not let the peak be reset.
template <class Work>
double peak_bytes(Work work) {
  return_memory();
  std::ofstream reset("/proc/self/clear_refs");
  const bool was_reset = bool(reset << "5" << std::flush);
  const double before = memory("VmRSS:");
  work();
  return was_reset ? memory("VmHWM:") - before : std::numeric_limits<double>::quiet_NaN();
}

void bench_fill(benchmark::State& state, const dem::ChosenMethod& chosen, int side,
                double percent) {
  const dem::Dem& whole = truth(side);
  const auto cells = double(whole.size().cells());
  const dem::Dem problem =
      dem::sample_random(whole, std::size_t(std::llround(cells * percent / 100)));
  const auto fill = [&] { return chosen.method->fill(problem, chosen.settings, one_thread); };

  // Calls outside the clock: one for memory and error, one that leaves its memory to the others.
  dem::Filled filled;
  const double peak = peak_bytes([&] { filled = fill(); });
  const dem::Errors errors =
      dem::compare(whole.z, filled.z, removed_cells(whole, problem), std::array{whole.spacing});
  filled = {};
  keep_memory();
  benchmark::DoNotOptimize(fill());

  const std::clock_t start = std::clock();
  for (auto _ : state) benchmark::DoNotOptimize(fill());
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;

  state.counters["ns_per_cell"] = 1e9 * seconds / (double(state.iterations()) * cells);
  state.counters["bytes_per_cell"] = peak / cells - sizeof(float);
  state.counters["rmse_m"] = errors.rmse_m;
}

/// Each method with its defaults, and with each of its presets.
std::vector<std::string> names_of(const std::vector<dem::FillMethod>& table) {
  std::vector<std::string> names;
  for (const auto& method : table) {
    names.push_back(method.name);
    for (const auto& preset : method.presets) names.push_back(method.name + ":" + preset.name);
  }
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  const auto& table = dem::all_fill_methods();
  const auto add = [&](const std::string& name, int side, double percent) {
    benchmark::RegisterBenchmark(
        fmt::format("fill/{}/{}/{}", name, side, percent).c_str(),
        [chosen = dem::find_method(table, name), side, percent](benchmark::State& state) {
          bench_fill(state, chosen, side, percent);
        })
        ->Unit(benchmark::kMillisecond);
  };
  for (const auto& name : names_of(table))
    for (int side : {1025, 4097})
      for (double percent : {50.0, 10.0, 3.4, 1.0}) add(name, side, percent);
  add("mcmd", 16385, 3.4);

  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  if (mount_washington().empty())
    std::cerr << "DEM_TESTDATA is not set: 1025 x 1025 is a fractal, not Mount Washington\n";
  benchmark::RunSpecifiedBenchmarks();
}
