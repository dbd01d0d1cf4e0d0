// dem render: pictures of a DEM.

#include <algorithm>
#include <chrono>
#include <map>

#include "dem/draw.h"
#include "dem/io/image.h"
#include "dem/io/places.h"
#include "dem/raytrace.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out, style = "relief", size, camera, target;
  std::map<std::string, std::string> given;  // what stands for fields of the style's options
  ReadOptions read;
};

/// The fields that `style` draws with; width and height are --size.
std::vector<std::string> field_names(const std::string& style) {
  HillshadeOptions hillshade;
  ReliefOptions relief;
  ViewOptions view;
  std::vector<std::string> names;
  for (const auto& f : style == "hillshade" ? fields(hillshade)
                       : style == "relief"  ? fields(relief)
                                            : fields(view))
    if (f.name() != "width" && f.name() != "height") names.push_back(f.name());
  return names;
}

Settings settings(const Options& o) {
  const auto names = field_names(o.style);
  Settings settings;
  for (const auto& [name, text] : o.given) {
    if (std::ranges::count(names, name) == 0)
      throw std::invalid_argument(fmt::format("--{} is not for style {}, which has {}", name,
                                              o.style, fmt::join(names, ", ")));
    settings.emplace_back(name, text);
  }
  if (o.style != "view")
    for (const auto& [name, text] :
         {std::pair{"--size", o.size}, {"--camera", o.camera}, {"--target", o.target}})
      if (!text.empty())
        throw std::invalid_argument(
            fmt::format("{} is for --style view; {} has one pixel for each cell", name, o.style));
  return settings;
}

/// "1600x900".
Settings picture_size(const std::string& text) {
  if (text.empty()) return {};
  const auto x = text.find('x');
  if (x == std::string::npos) refuse("--size", text, "WIDTHxHEIGHT, for example 1600x900");
  return {{"width", text.substr(0, x)}, {"height", text.substr(x + 1)}};
}

ViewOptions view_options(const Options& o, const Dem& dem, Settings settings) {
  for (auto& setting : picture_size(o.size)) settings.push_back(std::move(setting));
  ViewOptions view;
  dem::apply(settings, fields(view));
  if (!o.camera.empty()) view.camera = place_in(dem, "--camera", o.camera);
  if (!o.target.empty()) view.target = place_in(dem, "--target", o.target);
  return view;
}

/// A DEM of 2 x 2 cells: cheap to draw, so that bad settings show before long work.
Dem trial() { return {Raster<float>({2, 2}), Mask({2, 2}, 1), {}, {}}; }

int render(const Options& o, Shell& shell) {
  const Settings chosen = settings(o);
  if (o.style == "view") {
    Options plain = o;
    plain.camera.clear(), plain.target.clear();
    make_view(trial(), view_options(plain, trial(), chosen));
  } else if (o.style == "relief") {
    ReliefOptions relief;
    dem::apply(chosen, fields(relief));
  } else {
    HillshadeOptions light;
    dem::apply(chosen, fields(light));
  }
  if (!o.camera.empty()) check_place("--camera", o.camera);
  if (!o.target.empty()) check_place("--target", o.target);
  check_writable(o.out, shell.overwrite);

  const Run run = shell.run();
  const Dem dem = read_dem(o.in, o.read, run.part(0, 0.1)).dem;
  const auto start = std::chrono::steady_clock::now();
  const Run drawing = run.part(0.1, 1);
  Size size = dem.size();
  double exaggeration = 1;
  if (o.style == "hillshade") {
    HillshadeOptions light;
    dem::apply(chosen, fields(light));
    exaggeration = light.exaggeration;
    write_image(o.out, hillshade(dem.z, dem.spacing, light, dem.known, drawing), shell.overwrite);
  } else if (o.style == "relief") {
    ReliefOptions relief;
    dem::apply(chosen, fields(relief));
    exaggeration = relief.light.exaggeration;
    write_image(o.out, shaded_relief(dem.z, dem.spacing, relief, dem.known, drawing),
                shell.overwrite);
  } else {
    ViewOptions view = view_options(o, dem, chosen);
    exaggeration = view.exaggeration = make_view(dem, view).exaggeration;
    size = {view.width, view.height};
    write_image(o.out, render_view(dem, view, drawing), shell.overwrite);
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  shell.say("{}: {} of {} x {} pixels, heights x {:g}, {:.2f} s", o.out, o.style, size.cols,
            size.rows, exaggeration, seconds);
  shell.print({{"output", o.out},
               {"style", o.style},
               {"width", size.cols},
               {"height", size.rows},
               {"exaggeration", exaggeration},
               {"seconds", seconds}},
              "");
  return kDone;
}

/// An option for each field: --name VALUE; a switch that is off is --name, one that is on
/// --no-name.
void add_field_options(Command& verb, const std::shared_ptr<Options>& o) {
  ReliefOptions relief;
  ViewOptions view;
  const auto of_maps = fields(relief), of_views = fields(view);
  const auto add = [&](const Field& f, const std::string& group, const std::string& normally) {
    verb.heading(group);
    if (f.type() == "boolean") {
      const bool on = f.text() == "true";
      verb.flag_that((on ? "--no-" : "--") + f.name(),
                     [o, name = f.name(), on] { o->given[name] = on ? "false" : "true"; },
                     on ? "Without " + f.doc() : f.doc());
      return;
    }
    verb.option_read_by(
            "--" + f.name(),
            [o, name = f.name()](const std::string& text) { o->given[name] = text; },
            f.choices().empty() ? "N" : "NAME",
            f.choices().empty() ? f.doc() : f.doc() + ": " + f.range())
        .kind(f.choices().empty() ? "number" : "")
        .suggest(f.choices())
        .show_default(normally);
  };
  for (const auto& f : of_maps) {
    const auto same = std::ranges::find(of_views, f.name(), &Field::name);
    const bool both = same != of_views.end();
    const bool differ = both && same->text() != f.text();
    add(both ? *same : f, both ? "All styles" : "Maps",
        differ ? f.text() + "; view: " + same->text() : f.text());
  }
  for (const auto& f : of_views)
    if (f.name() != "width" && f.name() != "height" &&
        std::ranges::find(of_maps, f.name(), &Field::name) == of_maps.end())
      add(f, "Views", f.text());
}

std::string palette_lines() {
  std::string text;
  for (const auto& p : palettes()) text += fmt::format("  {:<9} {}\n", p.name, p.doc);
  return text;
}

}  // namespace

void add_render(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb =
      program.add("render", kEveryday, "Draw a DEM: hillshade, colour relief or perspective view",
                  "  dem render N44W072.hgt relief.png\n"
                  "  dem render N44W072.hgt shade.png --style hillshade --multidirectional\n"
                  "  dem render N44W072.hgt block.png --style view --palette alpine --samples 16\n"
                  "  dem render N44W072.hgt summit.png --style view --camera=-71.2,44.1,+300 \\\n"
                  "      --target=-71.3,44.27,1900 --fov 50");
  verb.notes = "Palettes:\n" + palette_lines();
  verb.work = [o, &shell] { return render(*o, shell); };
  verb.argument("IN", o->in, "DEM, in any format that GDAL opens").kind("raster").must_be_given();
  verb.argument("OUT", o->out, "Picture, in the format of its extension: .png, .jpg or .tif")
      .kind("new picture")
      .must_be_given();
  verb.option("--style", o->style, "STYLE",
              "hillshade or relief (maps with one pixel for each cell) or view")
      .one_of({"hillshade", "relief", "view"})
      .show_default();
  add_field_options(verb, o);
  verb.heading("Views");
  verb.option("--size", o->size, "WxH", "Width and height of the picture in pixels")
      .show_default("1600x900");
  verb.option("--camera", o->camera, "X,Y,Z",
              "Place of the camera in the coordinates of the DEM; a Z of +METRES is above ground");
  verb.option("--target", o->target, "X,Y,Z", "Place that the camera looks at")
      .show_default("the middle of the terrain");
  add_read_options(verb, o->read);
}

}  // namespace dem::app
