// dem supersample: a DEM on a finer lattice.

#include "dem/supersample.h"

#include "dem/io/methods.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out;
  std::string method{default_fill_method()};
  std::vector<std::string> set;
  bool roughness = false;
  std::uint64_t seed = 1;
  SupersampleOptions super;
  ReadOptions read;
  WriteOptions write;
};

ChosenMethod choose(const Options& o) {
  ChosenMethod chosen = find_method(all_fill_methods(), o.method);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (o.roughness) {
    if (!chosen.method->has_setting("realisation"))
      throw std::invalid_argument("--roughness is the spline's; method " + o.method + " has none");
    chosen.settings.emplace_back("realisation", "1");
    chosen.settings.emplace_back("seed", std::to_string(o.seed));
  }
  chosen.check();
  return chosen;
}

int run_supersample(const Options& o, Shell& shell) {
  const ChosenMethod method = choose(o);
  check_options(o.super);
  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  check_writable(o.out, write);
  const Run run = shell.run();
  DemFile file = read_dem(o.in, o.read, run.part(0, 0.1));
  if (count(file.dem.known) == 0) throw IoError(o.in, "no known cell");
  SupersampleOptions options = o.super;
  options.nodes = file.source.node_registered;
  const Supersampled fine = supersample(file.dem, method, options, run.part(0.1, 0.9));
  const Lattice lattice = finer_lattice(file.dem, options);

  Source source = file.source;
  source.exact = {};
  source.type = CellType::float32;
  source.nodata.reset();
  if (holds_metadata(o.out, o.write.format))
    write.metadata = {{"DEM_METHOD", o.method}, {"DEM_VERSION", DEM_VERSION}};
  const Dem dem{fine.filled.z, Mask(lattice.size, 1), lattice.ref, lattice.spacing};
  write_dem(o.out, dem, source, write, run.part(0.9, 1));

  const bool means = options.preserve == Preserve::means;
  shell.say(
      "{} x {} cells of {:.6g} x {:.6g} m from {} x {}; coarse {} missed by {:.3g} m (RMS), "
      "{:.3g} m at most: {}",
      lattice.size.cols, lattice.size.rows, lattice.spacing.dx_m, lattice.spacing.dy_m,
      file.dem.size().cols, file.dem.size().rows, means ? "means" : "heights", fine.miss_rms_m,
      fine.miss_max_m, o.out);
  shell.print({{"output", o.out},
               {"cols", lattice.size.cols},
               {"rows", lattice.size.rows},
               {"cell_m", {lattice.spacing.dx_m, lattice.spacing.dy_m}},
               {"preserve", field(options, "preserve").text()},
               {"miss_rms_m", fine.miss_rms_m},
               {"miss_max_m", fine.miss_max_m}},
              "");
  return kDone;
}

}  // namespace

void add_supersample(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb =
      program.add("supersample", kEveryday, "Interpolate a DEM to a smaller cell size",
                  "  dem supersample coarse.tif fine.tif --factor 3\n"
                  "  dem supersample means.tif fine.tif --factor 2.5 --preserve block-mean\n"
                  "  dem supersample coarse.tif rough.tif --factor 4 --roughness");
  verb.work = [o, &shell] { return run_supersample(*o, shell); };
  verb.argument("IN", o->in, "DEM; its nodata cells are filled too").kind("raster").must_be_given();
  verb.argument("OUT", o->out, "The finer DEM, in float32").kind("new raster").must_be_given();
  verb.option("-f,--factor", o->super.factor, "N", "How many times finer: 2 halves the cell size")
      .above(1)
      .must_be_given();
  verb.option_read_by(
          "--preserve", [o](const std::string& what) { field(o->super, "preserve").set(what); },
          "WHAT",
          "What the finer DEM keeps: the heights at the coarse centres, or the mean of each coarse "
          "cell")
      .one_of(field(o->super, "preserve").choices())
      .show_default("heights");
  verb.flag("--roughness", o->roughness,
            "Add random relief below the old cell size, as rough as the terrain");
  verb.option("--seed", o->seed, "N", "Random seed for --roughness").show_default();
  verb.option("-m,--method", o->method, "NAME", "Fill method (see `dem methods`)")
      .suggest(names_and_presets(all_fill_methods()))
      .show_default();
  add_set_option(verb, o->set, "method");
  add_read_options(verb, o->read);
  add_write_options(verb, o->write);
}

}  // namespace dem::app
