// dem reproduce: published results, end to end.

#include "reproduce/reproduce.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>

#include "dem/io/geodesy.h"
#include "dem/io/image.h"
#include "dem/methods.h"

namespace dem::app {
namespace fs = std::filesystem;

std::string find_data(const ReproduceOptions& o, const std::vector<std::string>& names) {
  std::vector<std::string> folders;
  const char* testdata = std::getenv("DEM_TESTDATA");
  if (!o.data.empty())
    folders = {o.data};
  else if (testdata && *testdata)
    folders = {testdata};
  else
    folders = {"../shared/data"};
  for (const auto& folder : folders)
    for (const auto& name : names)
      if (std::error_code e; fs::exists(fs::path(folder) / name, e))
        return (fs::path(folder) / name).string();
  return "";
}

DemFile read_tile(const std::string& path, const Run& run) {
  ReadOptions options;
  std::smatch name;
  const std::string file = fs::path(path).filename().string();
  static const std::regex tile("^([NS][0-9]{2}[EW][0-9]{3})[.].*hgt.*$");
  if (std::regex_match(file, name, tile)) options.tile = name[1];
  return read_dem(path, options, run);
}

Dem window_around_summit(const Dem& dem, int size) {
  int top_col = 0, top_row = 0;
  float top = -1e30f;
  for (int r = 0; r < dem.z.rows(); ++r)
    for (int c = 0; c < dem.z.cols(); ++c)
      if (dem.known(c, r) && dem.z(c, r) > top) top = dem.z(c, r), top_col = c, top_row = r;
  const Size part{std::min(size, dem.z.cols()), std::min(size, dem.z.rows())};
  const int col0 = std::clamp(top_col - part.cols / 2, 0, dem.z.cols() - part.cols);
  const int row0 = std::clamp(top_row - part.rows / 2, 0, dem.z.rows() - part.rows);

  Dem window{Raster<float>(part), Mask(part), dem.ref, {}};
  for (int r = 0; r < part.rows; ++r) {
    std::ranges::copy(dem.z.row(row0 + r).subspan(std::size_t(col0), std::size_t(part.cols)),
                      window.z.row(r).begin());
    std::ranges::copy(dem.known.row(row0 + r).subspan(std::size_t(col0), std::size_t(part.cols)),
                      window.known.row(r).begin());
  }
  auto& w = window.ref.to_world;
  w[0] += w[1] * col0 + w[2] * row0;
  w[3] += w[4] * col0 + w[5] * row0;
  window.spacing = middle_spacing(window.ref, part);
  return window;
}

McmdOptions mcmd_options(const std::string& name) {
  McmdOptions options;
  dem::apply(find_method(fill_methods(), name).settings, fields(options));
  return options;
}

void draw(Findings& findings, const std::string& path, const Raster<float>& z, Spacing spacing,
          bool overwrite, const Mask& known) {
  const auto add = [&](auto picture) {
    findings.pictures.push_back(path);
    findings.writers.push_back(
        [path, overwrite, picture = std::move(picture)] { write_image(path, picture, overwrite); });
  };
  if (known.empty())
    add(hillshade(z, spacing));
  else
    add(shaded_relief(z, spacing, {}, known));
}

namespace {

std::string as_text(const Findings& f) {
  std::string text;
  if (!f.numbers.empty())
    text += fmt::format("{:<50}{:>12}{:>12}{:>12}\n", "", "paper", "ours", "ours/paper");
  for (const auto& n : f.numbers) {
    const auto value = [&](double v) { return fmt::format("{:.4g} {}", v, n.unit); };
    text += fmt::format("{:<50}{:>12}{:>12}{:>12}\n", n.what, n.paper ? value(*n.paper) : "",
                        value(n.ours), n.paper ? fmt::format("{:.4g}", n.ours / *n.paper) : "");
  }
  for (const auto& note : f.notes) text += note + "\n";
  if (!f.table.empty()) text += "\n" + f.table;
  if (!f.pictures.empty()) text += "\npictures\n";
  for (const auto& p : f.pictures) text += "  " + p + "\n";
  return text;
}

Json as_json(const std::string& what, const Findings& f) {
  Json numbers = Json::array();
  for (const auto& n : f.numbers)
    numbers.push_back({{"what", n.what},
                       {"unit", n.unit},
                       {"paper", n.paper ? Json(*n.paper) : Json()},
                       {"ours", n.ours},
                       {"ratio", n.paper ? Json(n.ours / *n.paper) : Json()}});
  Json json{{"what", what},
            {"numbers", numbers},
            {"notes", f.notes},
            {"pictures", f.pictures},
            {"failures", f.failures}};
  json.update(f.extra);
  return json;
}

int reproduce(const ReproduceOptions& o, Shell& shell) {
  const OutputFolder folder(o.dir);
  Findings findings;
  if (o.what == "mount-washington")
    findings = reproduce_mount_washington(o, folder, shell);
  else if (o.what == "n36e008")
    findings = reproduce_n36e008(o, folder, shell);
  else
    findings = reproduce_figures(o, folder, shell);
  for (const auto& write : findings.writers) write();
  shell.print(as_json(o.what, findings), as_text(findings));
  if (findings.failures.empty()) return kDone;
  fmt::print(stderr, "dem: check failed: {}\n", fmt::join(findings.failures, "; "));
  return kCheckFailed;
}

}  // namespace

void add_reproduce(Program& program, Shell& shell) {
  const auto o = std::make_shared<ReproduceOptions>();
  Command& verb = program.add(
      "reproduce", kMeasure, "Repeat a published experiment and compare its numbers with ours",
      "  dem reproduce mount-washington results            # 35721 of 1025 x 1025 cells\n"
      "  dem reproduce mount-washington results --tile N44W072.hgt\n"
      "  dem reproduce n36e008 results --data ~/srtm       # Sobel edges, real voids\n"
      "  dem reproduce figures pictures                    # pictures of the parameters");
  verb.work = [o, &shell] { return reproduce(*o, shell); };
  verb.argument("WHAT", o->what, "Experiment: mount-washington, n36e008 or figures")
      .one_of({"mount-washington", "n36e008", "figures"})
      .must_be_given();
  verb.argument("DIR", o->dir, "Folder for pictures and curves").kind("new folder").must_be_given();
  verb.option("-t,--tile", o->tile, "FILE", "DEM to use, in any format that GDAL opens")
      .kind("raster");
  verb.option("--data", o->data, "DIR",
              "Folder of tiles ($DEM_TESTDATA if it is set, otherwise ../shared/data)")
      .kind("folder");
  verb.option("--repeats", o->repeats, "N",
              "Number of runs of each measurement; the median time is reported")
      .within(1, 1000)
      .show_default();
}

}  // namespace dem::app
