// dem deterrace: take the steps of whole metres off a DEM.

#include "dem/deterrace.h"

#include <CLI/CLI.hpp>

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

void add_deterrace(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb = add_verb(app, shell, "deterrace", "Take the steps of whole metres off a DEM",
                        "  dem deterrace N36E008.hgt smooth.tif\n"
                        "  dem deterrace feet.tif smooth.tif --bound 0.1524",
                        [o, &shell] { return run_deterrace(*o, shell); });
  verb->add_option("IN", o->in, "a DEM with rounded heights")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("OUT", o->out, "the same without steps, in float32")
      ->required()
      ->check(takes("new raster"))
      ->type_name("");
  verb->add_option("-b,--bound", o->deterrace.bound_m, "no cell moves by more, in metres")
      ->type_name("METRES")
      ->capture_default_str();
  verb->add_option("--passes", o->deterrace.passes, "of relaxation on each grid of the pyramid")
      ->type_name("N")
      ->capture_default_str();
  add_read_options(*verb, o->read);
}

}  // namespace dem::app
