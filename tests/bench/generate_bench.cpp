// Speed of generators and of erosion, on one thread, in CPU time:
//
//   generate/NAME[:PRESET]/SIZE    cells_per_s; noise: octaves_per_s too, cells times octaves
//   generate/faults:COUNT/SIZE     the cost law: rows * (count + cols)
//   erode/SIZE                     cell_steps_per_s, water and talus
//
// Example: build/release/tests/bench/generate_bench --benchmark_filter='generate/noise.*'

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <ctime>
#include <string>

#include "dem/erosion.h"
#include "dem/faults.h"
#include "dem/generators.h"
#include "dem/noise.h"

namespace {

const dem::Run one_thread{.threads = 1, .progress = {}};

dem::Canvas square(int side) { return {{side, side}, {30, 30}, {}}; }

/// Runs the benchmark and gives `amount` of work a call as a rate.
template <class Work>
void measure(benchmark::State& state, const char* counter, double amount, Work work) {
  const std::clock_t start = std::clock();
  for (auto _ : state) benchmark::DoNotOptimize(work());
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  state.counters[counter] = amount * double(state.iterations()) / seconds;
}

void bench_generator(benchmark::State& state, const std::string& name, int side) {
  const auto chosen = dem::find_generator(name);
  dem::Canvas canvas = square(side);
  if (chosen.generator->globe) canvas.ref.to_world = {-180, 360.0 / side, 0, 90, 0, -180.0 / side};
  measure(state, "cells_per_s", double(side) * side,
          [&] { return chosen.generator->generate(canvas, {}, chosen.settings, one_thread); });
}

void bench_noise(benchmark::State& state, int octaves, int side) {
  dem::NoiseOptions options;
  options.octaves = octaves;
  const dem::Canvas canvas = square(side);
  const double cells = double(side) * side;
  measure(state, "cells_per_s", cells,
          [&] { return dem::generate_noise(canvas, options, one_thread); });
  state.counters["octaves_per_s"] = double(state.counters["cells_per_s"]) * octaves;
}

void bench_faults(benchmark::State& state, int count, int side) {
  const dem::Canvas canvas = square(side);
  measure(state, "cells_per_s", double(side) * side,
          [&] { return dem::generate_faults(canvas, {.count = count}, one_thread); });
}

void bench_erosion(benchmark::State& state, int side) {
  const dem::Canvas canvas = square(side);
  const dem::Dem hills = dem::on_canvas(canvas, dem::generate_noise(canvas, {}, one_thread));
  const int steps = side > 1000 ? 20 : 200;
  measure(state, "cell_steps_per_s", double(side) * side * steps,
          [&] { return dem::erode(hills, {.steps = steps}, one_thread); });
}

template <class Bench>
void add(const std::string& name, Bench bench) {
  benchmark::RegisterBenchmark(name.c_str(), bench)->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  for (const auto& generator : dem::generators()) {
    if (!generator.image.empty()) continue;
    std::vector<std::string> names{generator.name};
    for (const auto& preset : generator.presets)
      names.push_back(generator.name + ":" + preset.name);
    for (const auto& name : names)
      add(fmt::format("generate/{}/1025", name),
          [name](benchmark::State& state) { bench_generator(state, name, 1025); });
  }
  for (int octaves : {1, 10})
    add(fmt::format("generate/noise:{}-octaves/1025", octaves),
        [octaves](benchmark::State& state) { bench_noise(state, octaves, 1025); });
  for (int count : {1000, 10000, 100000})
    add(fmt::format("generate/faults:{}/1025", count),
        [count](benchmark::State& state) { bench_faults(state, count, 1025); });
  for (int side : {257, 1025, 4097})
    add(fmt::format("erode/{}", side),
        [side](benchmark::State& state) { bench_erosion(state, side); });

  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
