// Speed of the generators that draw lines first, on one thread. The papers' figures are for the
// machines of their years: 0.45 s [belhadj2005] and 0.61 s [belhadj2007] for a skeleton and its
// terrain of 512 x 512, 4 s [teoh2009] for RiverLand of 1024 x 1024.
//
//   build/release/tests/bench/network_bench

#include <benchmark/benchmark.h>

#include "dem/mcmd.h"
#include "dem/networks.h"
#include "dem/riverland.h"
#include "dem/sketch.h"

namespace {

const dem::Run one_thread{.threads = 1, .progress = {}};
const dem::Spacing cell{30, 30};

dem::Size square(const benchmark::State& state) {
  return {int(state.range(0)), int(state.range(0))};
}

/// MCMD of a skeleton with its own bends for ridges and rivers, without noise.
void fill_skeleton(benchmark::State& state) {
  const dem::Skeleton s = dem::grow_skeleton(square(state), cell, {}, one_thread);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        dem::fill_mcmd(s.dem, {.I_bu = 5, .I_bu_ridge = 5}, one_thread, s.kinds));
}
BENCHMARK(fill_skeleton)->Arg(1024)->Unit(benchmark::kMillisecond);

void ridges_and_rivers(benchmark::State& state) {
  const dem::Canvas canvas{square(state), cell, {}};
  for (auto _ : state) benchmark::DoNotOptimize(dem::generate_ridges(canvas, {}, one_thread));
}
BENCHMARK(ridges_and_rivers)->Arg(512)->Arg(1024)->Unit(benchmark::kMillisecond);

void riverland(benchmark::State& state) {
  const dem::Land land = dem::make_island(square(state), 1, one_thread);
  for (auto _ : state) benchmark::DoNotOptimize(dem::make_riverland(land, cell, {}, one_thread));
}
BENCHMARK(riverland)->Arg(256)->Arg(512)->Arg(1024)->Unit(benchmark::kMillisecond);

void lsystem(benchmark::State& state) {
  const dem::Canvas canvas{square(state), cell, {}};
  for (auto _ : state) benchmark::DoNotOptimize(dem::generate_lsystem(canvas, {}, one_thread));
}
BENCHMARK(lsystem)->Arg(512)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
