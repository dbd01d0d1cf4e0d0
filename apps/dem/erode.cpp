// dem erode: wear a terrain down.

#include "dem/erosion.h"

#include <chrono>
#include <optional>

#include "dem/methods.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out, water, frames;
  int every = 100;
  std::vector<std::string> set;
  ReadOptions read;
};

ErosionOptions parse_settings(const std::vector<std::string>& set) {
  ErosionOptions options;
  Settings settings;
  for (const auto& text : set) settings.push_back(parse_setting(text));
  dem::apply(settings, fields(options));
  return options;
}

std::string frame_name(int step) { return fmt::format("step_{:06}.tif", step); }

/// Heights in whole metres would lose most of what a step does, so OUT holds fractions if it can.
WriteOptions writing(const std::string& path, const Shell& shell) {
  WriteOptions write;
  write.overwrite = shell.overwrite;
  if (holds_metadata(path, "")) write.type = CellType::float32;
  return write;
}

std::string settings_text(const std::vector<std::string>& set) {
  return fmt::format("{}", fmt::join(set, " "));
}

void report(const Options& o, const ErosionOptions& options, const Eroded& eroded,
            std::size_t cells, double seconds, Shell& shell) {
  const double steps = double(cells) * options.steps;
  shell.say(
      "eroded {} cells in {} steps, {:.4g} m3 left over the border; {:.3f} s, {:.0f} million "
      "cell-steps/s: {}",
      grouped(cells), options.steps, eroded.carried_m3, seconds,
      seconds > 0 ? steps / seconds / 1e6 : 0, o.out);
  shell.print({{"output", o.out},
               {"steps", options.steps},
               {"before_m3", eroded.before_m3},
               {"after_m3", eroded.after_m3},
               {"carried_m3", eroded.carried_m3},
               {"seconds", seconds}},
              "");
}

int run_erode(const Options& o, Shell& shell) {
  const ErosionOptions options = parse_settings(o.set);
  check_writable(o.out, shell.overwrite);
  if (!o.water.empty()) check_writable(o.water, shell.overwrite);
  std::optional<OutputFolder> folder;
  if (!o.frames.empty()) {
    folder.emplace(o.frames);
    for (int step = o.every; step <= options.steps; step += o.every)
      check_writable(folder->file(frame_name(step)), shell.overwrite);
  }

  const Run run = shell.run();
  const DemFile file = read_dem(o.in, o.read, run.part(0, 0.1));
  if (count(file.dem.known) == 0) throw IoError(o.in, "no known cell; there is nothing to erode");
  Source source = file.source;
  source.exact = {};

  ErosionFrames frames;
  if (folder) {
    frames.every = o.every;
    frames.take = [&](const ErosionFrame& frame) {
      const std::string path = folder->file(frame_name(frame.step));
      write_dem(path, {frame.z, file.dem.known, file.dem.ref, file.dem.spacing}, source,
                writing(path, shell));
    };
  }
  const auto start = std::chrono::steady_clock::now();
  Eroded eroded = erode(file.dem, options, run.part(0.1, 0.9), frames);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  if (!o.water.empty()) {
    Source described;
    described.node_registered = source.node_registered;
    described.band_description = "depth of water in metres";
    write_dem(o.water, {eroded.water_m, file.dem.known, file.dem.ref, file.dem.spacing}, described,
              writing(o.water, shell));
  }
  WriteOptions write = writing(o.out, shell);
  if (holds_metadata(o.out, ""))
    write.metadata = {{"DEM_EROSION", settings_text(o.set)}, {"DEM_VERSION", DEM_VERSION}};
  write_dem(o.out, {eroded.z, file.dem.known, file.dem.ref, file.dem.spacing}, source, write,
            run.part(0.9, 1));
  report(o, options, eroded, count(file.dem.known), seconds, shell);
  return kDone;
}

/// The settings, for the help.
std::string settings_help() {
  ErosionOptions defaults;
  std::string text = "Settings (-s KEY=VALUE):\n";
  for (const auto& f : describe(fields(defaults)))
    text += fmt::format("  {:<15} {:<9} {}\n", f.name,
                        f.default_text + (f.unit.empty() ? "" : " " + f.unit), f.doc);
  return text;
}

}  // namespace

void add_erode(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "erode", kSynthesize, "Erode a DEM by running water and falling rock",
      "  dem erode hills.tif eroded.tif\n"
      "  dem erode hills.tif eroded.tif -s steps=2000 -s talus_deg=33\n"
      "  dem erode N44W072.hgt later.tif --frames film --every 50     # film/step_000050.tif ...");
  verb.notes =
      "Nodata cells act as a wall: nothing flows in or out of them, and they stay nodata.\n" +
      settings_help();
  verb.work = [o, &shell] { return run_erode(*o, shell); };
  verb.argument("IN", o->in, "DEM, in any format that GDAL opens").kind("raster").must_be_given();
  verb.argument("OUT", o->out, "The eroded DEM, in float32 where the format allows it")
      .kind("new raster")
      .must_be_given();
  add_set_option(verb, o->set, "erosion (see below)");
  verb.option("--water", o->water, "FILE", "Also write the depth of the water after the last step")
      .kind("new raster");
  verb.option("--frames", o->frames, "DIR",
              "Also write the terrain after every few steps into a folder")
      .kind("new folder");
  verb.option("--every", o->every, "N", "Number of steps from one frame to the next")
      .within(1, 1000000)
      .show_default();
  add_read_options(verb, o->read);
}

}  // namespace dem::app
