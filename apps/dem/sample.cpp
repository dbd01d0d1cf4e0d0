// dem sample: make a problem from a whole DEM.

#include "dem/sample.h"

#include <CLI/CLI.hpp>
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
  std::vector<CLI::Option*> ways;  // of which one is to be given
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
  if (std::ranges::count_if(o.ways, [](const CLI::Option* way) { return way->count() > 0; }) != 1)
    throw std::invalid_argument(
        "exactly one of --keep, --count, --every, --edges, --voids, --tracks, --contours, "
        "--greedy, "
        "--max-error is needed (see `dem sample --help`)");
  find_method(all_fill_methods(), o.method);
  for (const auto& [name, text] :
       {std::pair{"keep", o.keep}, {"edges", o.edges}, {"voids", o.voids}})
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
    return {sample_random(dem, cells_of(parse_share("keep", o.keep), known), o.seed),
            "random" + seed};
  if (o.every) return {sample_regular(dem, o.every), fmt::format("every {} cells", o.every)};
  if (!o.edges.empty())
    return {sample_edges(dem, cells_of(parse_share("edges", o.edges), known)), "Sobel edges"};
  if (!o.voids.empty())
    return {sample_voids(
                dem, {.remove = cells_of(parse_share("voids", o.voids), known), .seed = o.seed}),
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

void add_sample(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb =
      add_verb(app, shell, "sample", "Make a problem from a whole DEM: keep some cells only",
               "  dem sample whole.tif sparse.tif --keep 3.4%      # random cells\n"
               "  dem sample whole.tif sparse.tif --count 35721 --seed 7\n"
               "  dem sample N44W072.hgt edges.tif --edges 10%     # silhouettes, by Sobel\n"
               "  dem sample whole.tif holed.tif --voids 5%        # holes as SRTM has them",
               [o, &shell] { return run_sample(*o, shell); });
  verb->add_option("IN", o->in, "a DEM, as whole as can be")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("OUT", o->out, "the same with fewer known cells")
      ->required()
      ->check(takes("new raster"))
      ->type_name("");
  const auto way = [&](const char* name, auto& value, const char* type, const char* doc) {
    return verb->add_option(name, value, doc)->type_name(type)->group("How (exactly one)");
  };
  const auto positive = [](const std::string& text) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
    return good ? std::string() : text + "; must be a number above 0";
  };
  o->ways = {
      way("--keep", o->keep, "P%", "keep this share of the known cells, at random"),
      way("--count", o->count, "N", "keep this many cells, at random")->check(positive),
      way("--every", o->every, "N", "keep every N-th column and row")->check(positive),
      way("--edges", o->edges, "P%", "keep this share, where Sobel's gradient is strongest"),
      way("--voids", o->voids, "P%", "cut ragged voids until this share is gone"),
      way("--tracks", o->tracks, "N", "keep N straight tracks, as a ship's")->check(positive),
      way("--contours", o->contours, "METRES", "keep contour lines so far apart")->check(positive),
      way("--greedy", o->greedy, "N", "keep N cells, those that --method would miss worst")
          ->check(positive),
      way("--max-error", o->max_error, "METRES",
          "keep so many that --method misses no cell by more")
          ->check(positive)};
  verb->add_option("-m,--method", o->method, "that --greedy and --max-error reconstruct with")
      ->check(suggests(names_and_presets(all_fill_methods())))
      ->type_name("NAME")
      ->capture_default_str();
  verb->add_option("--seed", o->seed, "another seed, other cells; the same on every machine")
      ->check([](const std::string& text) {
        return text.starts_with('-') ? text + "; must be a whole number from 0 up" : std::string();
      })
      ->type_name("N")
      ->capture_default_str();
  add_read_options(*verb, o->read);
}

}  // namespace dem::app
