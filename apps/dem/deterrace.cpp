// dem deterrace: take the steps of whole metres off a DEM.

#include "dem/deterrace.h"

#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out;
  DeterraceOptions deterrace;
  ReadOptions read;
};

int run_deterrace(const Options& o, Shell& shell) {
  check_options(o.deterrace);
  check_writable(o.out, shell.overwrite);
  const Run run = shell.run();
  DemFile file = read_dem(o.in, o.read, run.part(0, 0.1));
  Deterraced smooth = deterrace(file.dem, o.deterrace, run.part(0.1, 0.9));
  file.dem.z = std::move(smooth.z);

  Source source = file.source;
  source.exact = {};
  source.type = CellType::float32;
  WriteOptions write;
  write.overwrite = shell.overwrite;
  if (holds_metadata(o.out, ""))
    write.metadata = {{"DEM_DETERRACE", fmt::format("bound {} m", o.deterrace.bound_m)}};
  write_dem(o.out, file.dem, source, write, run.part(0.9, 1));
  shell.say("cells moved by {:.3g} m (RMS), {:.3g} m at most: {}", smooth.moved_rms_m,
            smooth.moved_max_m, o.out);
  shell.print(
      {{"output", o.out}, {"moved_rms_m", smooth.moved_rms_m}, {"moved_max_m", smooth.moved_max_m}},
      "");
  return kDone;
}

}  // namespace

void add_deterrace(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add("deterrace", kEveryday,
                              "Remove the terraces of heights that were rounded to whole metres",
                              "  dem deterrace N36E008.hgt smooth.tif\n"
                              "  dem deterrace feet.tif smooth.tif --bound 0.1524");
  verb.work = [o, &shell] { return run_deterrace(*o, shell); };
  verb.argument("IN", o->in, "DEM with rounded heights, in any format that GDAL opens")
      .kind("raster")
      .must_be_given();
  verb.argument("OUT", o->out, "The DEM without terraces, in float32")
      .kind("new raster")
      .must_be_given();
  verb.option("-b,--bound", o->deterrace.bound_m, "METRES", "Largest change of a cell in metres")
      .show_default();
  verb.option("--passes", o->deterrace.passes, "N",
              "Number of relaxation passes on each grid of the pyramid")
      .show_default();
  add_read_options(verb, o->read);
}

}  // namespace dem::app
