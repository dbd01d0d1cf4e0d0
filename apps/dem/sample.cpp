// dem sample: make a problem from a whole DEM.

#include "dem/sample.h"

#include <algorithm>
#include <cmath>

#include "dem/greedy.h"
#include "dem/io/methods.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out;
  std::string keep, edges, voids;  // percentages of the known cells
  std::size_t count = 0;
  std::size_t greedy = 0;
  double max_error = 0;
  std::string method{default_fill_method()};  // that the greedy way reconstructs with
  int every = 0, tracks = 0;
  double contours = 0;
  std::uint64_t seed = 1;
  ReadOptions read;
  std::vector<const Option*> ways;  // of which one is to be given
};

struct Sampled {
  Dem dem;
  std::string how;
};

/// `share` of the known cells, at least one.
std::size_t cells_of(double share, std::size_t known) {
  return std::max<std::size_t>(1, std::size_t(std::llround(share * double(known))));
}

/// Before the file is read: one way of sampling, and percentages that are some.
void check_options(const Options& o) {
  if (std::ranges::count_if(o.ways, [](const Option* way) { return way->count > 0; }) != 1)
    throw std::invalid_argument(
        "exactly one of --keep, --count, --every, --edges, --voids, --tracks, --contours, "
        "--greedy, --max-error is needed (see `dem sample --help`)");
  find_method(all_fill_methods(), o.method);
  for (const auto& [name, text] :
       {std::pair{"--keep", o.keep}, {"--edges", o.edges}, {"--voids", o.voids}})
    if (!text.empty()) parse_share(name, text);
}

Sampled sample_by_need(const Options& o, const Dem& dem, const Run& run) {
  const ChosenMethod method = find_method(all_fill_methods(), o.method);
  GreedySample got =
      sample_greedy(dem, method, {.count = o.greedy, .max_error_m = o.max_error}, run);
  const GreedyRound& last = got.rounds.back();
  return {std::move(got.dem),
          fmt::format("greedy: {} reconstructs it with RMSE {:.4g} m, {:.4g} m at most", o.method,
                      last.rmse_m, last.max_error_m)};
}

Sampled sample(const Options& o, const Dem& dem, const Run& run) {
  const std::size_t known = count(dem.known);
  const std::string seed = fmt::format(", seed {}", o.seed);
  if (o.greedy || o.max_error > 0) return sample_by_need(o, dem, run);
  if (o.count) return {sample_random(dem, o.count, o.seed), "random" + seed};
  if (!o.keep.empty())
    return {sample_random(dem, cells_of(parse_share("--keep", o.keep), known), o.seed),
            "random" + seed};
  if (o.every) return {sample_regular(dem, o.every), fmt::format("every {} cells", o.every)};
  if (!o.edges.empty())
    return {sample_edges(dem, cells_of(parse_share("--edges", o.edges), known)), "Sobel edges"};
  if (!o.voids.empty())
    return {sample_voids(
                dem, {.remove = cells_of(parse_share("--voids", o.voids), known), .seed = o.seed}),
            "voids cut" + seed};
  if (o.tracks)
    return {sample_tracks(dem, o.tracks, o.seed), fmt::format("{} tracks", o.tracks) + seed};
  return {sample_contours(dem, o.contours), fmt::format("contours every {} m", o.contours)};
}

int run_sample(const Options& o, Shell& shell) {
  check_options(o);
  check_writable(o.out, shell.overwrite);
  const Run run = shell.run();
  const DemFile file = read_dem(o.in, o.read, run.part(0, 0.4));
  const std::size_t before = count(file.dem.known);
  if (before == 0) throw IoError(o.in, "no known cell; nothing can be sampled from it");

  run.report(0.4, "sampling");
  const Sampled sampled = sample(o, file.dem, run.part(0.4, 0.6));
  const std::size_t after = count(sampled.dem.known);

  // Contour cells have new heights, so the original values are not theirs any more.
  Source source = file.source;
  if (o.contours > 0) source.exact = {};
  WriteOptions write;
  write.overwrite = shell.overwrite;
  if (holds_metadata(o.out, "")) write.metadata = {{"DEM_SAMPLE", sampled.how}};
  write_dem(o.out, sampled.dem, source, write, run.part(0.6, 1));

  shell.say("kept {} of {} known cells ({}), {}: {}", grouped(after), grouped(before),
            percent_of(after, before), sampled.how, o.out);
  shell.print({{"output", o.out},
               {"how", sampled.how},
               {"known_before", before},
               {"known_after", after},
               {"share", double(after) / double(before)}},
              "");
  return kDone;
}

}  // namespace

void add_sample(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "sample", kMeasure, "Remove cells of a DEM, to make a test problem whose answer is known",
      "  dem sample whole.tif sparse.tif --keep 3.4%      # random cells\n"
      "  dem sample whole.tif sparse.tif --count 35721 --seed 7\n"
      "  dem sample N44W072.hgt edges.tif --edges 10%     # silhouettes, by the Sobel gradient\n"
      "  dem sample whole.tif holed.tif --voids 5%        # voids like those of SRTM");
  verb.work = [o, &shell] { return run_sample(*o, shell); };
  verb.argument("IN", o->in, "DEM without voids, or with few").kind("raster").must_be_given();
  verb.argument("OUT", o->out, "The DEM with fewer known cells").kind("new raster").must_be_given();
  verb.option("-m,--method", o->method, "NAME",
              "Fill method that --greedy and --max-error choose cells for")
      .suggest(names_and_presets(all_fill_methods()))
      .show_default();
  verb.option("--seed", o->seed, "N",
              "Random seed; the same seed gives the same cells on every machine")
      .show_default();
  verb.heading("How (exactly one)");
  const auto way = [&](const char* name, auto& value, const char* type,
                       const char* doc) -> Option& {
    Option& added = verb.option(name, value, type, doc);
    o->ways.push_back(&added);
    return added;
  };
  way("--keep", o->keep, "P%", "Keep this part of the known cells, chosen at random");
  way("--count", o->count, "N", "Keep this number of cells, chosen at random").above(0);
  way("--every", o->every, "N", "Keep the cells of every N-th column and row").above(0);
  way("--edges", o->edges, "P%",
      "Keep this part of the known cells, where Sobel's gradient is largest");
  way("--voids", o->voids, "P%", "Remove this part of the known cells, in ragged voids");
  way("--tracks", o->tracks, "N", "Keep the cells along N straight tracks, like those of a ship")
      .above(0);
  way("--contours", o->contours, "METRES", "Keep contour lines with this interval").above(0);
  way("--greedy", o->greedy, "N", "Keep the N cells that --method would miss most").above(0);
  way("--max-error", o->max_error, "METRES",
      "Keep as few cells as --method needs to miss no cell by more than this")
      .above(0);
  add_read_options(verb, o->read);
}

}  // namespace dem::app
