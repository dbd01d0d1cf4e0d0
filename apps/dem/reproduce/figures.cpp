// The parameter pictures of [belhadj2007] (figures 2, 3, 5, 6, 8) and the comparison of MD, MDI and
// both of [belhadj2005] (figures 3, 5, 6).

#include <algorithm>
#include <cmath>

#include "curve/chart.h"
#include "dem/io/image.h"
#include "reproduce/reproduce.h"
#include "reproduce/sketches.h"

namespace dem::app {
namespace {

using Picture = Raster<std::uint8_t>;

Picture shaded(const Raster<float>& z) { return hillshade(z, {}); }

/// Known heights alone as greys, high is dark as in the papers; unknown cells white.
Picture greys(const Dem& dem) {
  Picture picture(dem.size(), 255);
  for (std::size_t i = 0; i < picture.cells().size(); ++i)
    if (dem.known.cells()[i])
      picture.cells()[i] =
          std::uint8_t(std::clamp(200.0 - 200.0 * double(dem.z.cells()[i]) / kHigh, 0.0, 200.0));
  return picture;
}

/// Pictures of one size beside each other, `across` to a row, with a white gutter.
Picture sheet(const std::vector<Picture>& parts, int across) {
  constexpr int gutter = 12;
  const int n = int(parts.size()), down = (n + across - 1) / across;
  Picture all({across * (kSide + gutter) - gutter, down * (kSide + gutter) - gutter}, 255);
  for (int i = 0; i < n; ++i)
    for (int r = 0; r < kSide; ++r)
      std::ranges::copy(
          parts[std::size_t(i)].row(r),
          all.row(i / across * (kSide + gutter) + r).begin() + i % across * (kSide + gutter));
  return all;
}

MdOptions md(Subdivision subdivision, double I, double H, double rt, double rs) {
  return {.subdivision = subdivision, .I = I, .H = H, .rt = rt, .rs = rs};
}

McmdOptions mcmd(double I_bu, double I, double H = 0.5, double rt = 0, double rs = 0) {
  McmdOptions options = mcmd_options("mcmd:paper");
  options.I_bu = I_bu, options.I = I, options.H = H, options.rt = rt, options.rs = rs;
  return options;
}

Picture figure2(const Run& run) {
  const auto one = [&](Subdivision s, double rs) {
    return shaded(fill_md(five_points(), md(s, 0, 0.5, 0, rs), run));
  };
  return sheet({one(Subdivision::triangle_edge, 0), one(Subdivision::triangle_edge, 0.25),
                one(Subdivision::diamond_square, 0), one(Subdivision::diamond_square, 0.25)},
               4);
}

Picture figure3(const Run& run) {
  constexpr double sets[8][4] = {{-0.4, 0.5, 0, 0},     {-0.4, 0.5, 0, 0.25}, {-0.4, 0.5, -1, 0.25},
                                 {0.4, 0.5, 0, 0},      {0.4, 0.4, 0, 0.15},  {0.4, 0.4, 1, 0.15},
                                 {-2, 0.5, -0.9, 0.55}, {2, 0.5, -0.5, 0.6}};
  std::vector<Picture> parts;
  for (const auto& [I, H, rt, rs] : sets)
    parts.push_back(
        shaded(fill_md(five_points(), md(Subdivision::triangle_edge, I, H, rt, rs), run)));
  return sheet(parts, 4);
}

Picture figure5(const Run& run) {
  const Dem given = circle_and_segments();
  const Raster<float> z = fill_md(given, md(Subdivision::triangle_edge, 0, 0.5, 0, 0), run);
  return sheet({greys({z, Mask(z.size(), 1), {}, {}}), shaded(z)}, 2);
}

Picture figure8(const Run& run) {
  const Dem given = circle_and_segments();
  return sheet(
      {greys(carry_up_mcmd(given, mcmd(6, 1), run)), shaded(fill_mcmd(given, mcmd(6, 1), run)),
       shaded(fill_mcmd(given, mcmd(5, -0.7, 0.4, -1, 0.2), run))},
      3);
}

Picture skeleton_figures(const Run& run) {
  const Dem given = skeleton();
  const MdOptions plain = md(Subdivision::triangle_edge, 0, 0.5, 0, 0.1);
  MdiOptions both;
  both.rs_bu = 0.1, both.rs = 0.1;
  return sheet({greys(given), shaded(fill_md(given, plain, run)),
                greys(carry_up_mdi(given, both, run)), shaded(fill_mdi(given, both, run))},
               4);
}

/// Heights on a line of 257 cells, its ends unknown: figure 6 (and figure 4, which has the same).
std::string figure6(const Run& run) {
  Dem line = blank({257, 1});
  for (const auto& [col, height] :
       {std::pair{37, 55}, {75, 20}, {109, 62}, {141, 70}, {179, 30}, {221, 48}})
    put(line, col, 0, float(height));
  Series given{"given", {}, {}, false, true};
  for (int c = 0; c < 257; ++c)
    if (line.known(c, 0)) given.x.push_back(c), given.y.push_back(double(line.z(c, 0)));
  const auto curve = [](const std::string& name, const Raster<float>& z) {
    Series s{name, {}, {}, true, false};
    for (int c = 0; c < z.cols(); ++c) s.x.push_back(c), s.y.push_back(double(z(c, 0)));
    return s;
  };
  const auto panel = [&](const std::string& title, double rs) {
    const Raster<float> alone = fill_md(line, md(Subdivision::triangle_edge, 0, 0.25, 0, rs), run);
    const Raster<float> both = fill_mcmd(line, mcmd(0, 0, 0.25, 0, rs), run);
    return Panel{
        title, {"cell"}, {"elevation, m"}, {curve("MCMD", both), curve("MD alone", alone), given}};
  };
  return svg_chart("Figure 6: MCMD on a line (figure 4: MD alone)",
                   "The points are given; the ends are not.",
                   {panel("without noise", 0), panel("with noise in MD", 1)});
}

}  // namespace

Findings reproduce_figures(const ReproduceOptions&, const OutputFolder& folder, Shell& shell) {
  struct Figure {
    const char* file;
    const char* caption;
    Picture (*make)(const Run&);
  };
  const Figure figures[] = {
      {"figure2.png",
       "2: triangle-edge without and with noise, diamond-square without and with noise", figure2},
      {"figure3.png", "3 (a)-(d), (e)-(h): triangle-edge, the eight sets of I, H, rt, rs", figure3},
      {"figure5.png", "5: triangle-edge MD alone, dark is high; as a hillshade", figure5},
      {"figure8.png",
       "8: (a) after MDBU, (b) I_bu 6, I 1, (d) I_bu 5, I -0.7, H 0.4, rt -1, rs 0.2", figure8},
      {"belhadj2005.png", "belhadj2005 2, 3, 5, 6: skeleton, MD alone, MDI alone, both",
       skeleton_figures}};
  const std::string line = folder.file("figure6.svg");
  for (const auto& figure : figures) check_writable(folder.file(figure.file), shell.overwrite);
  check_writable(line, shell.overwrite);

  Findings f;
  const Run run = shell.run();
  double done = 0;
  for (const auto& figure : figures) {
    const std::string path = folder.file(figure.file);
    f.writers.push_back([path, picture = figure.make(run.part(done, done)),
                         overwrite = shell.overwrite] { write_image(path, picture, overwrite); });
    run.report(done += 1.0 / 6, figure.file);
    f.pictures.push_back(path);
    f.notes.push_back(fmt::format("figure {}", figure.caption));
  }
  f.writers.push_back([line, text = figure6(run.part(done, 1)), overwrite = shell.overwrite] {
    write_text(line, text, overwrite);
  });
  f.pictures.push_back(line);
  f.notes.push_back("figure 6: MCMD on a line, beside MD alone (figure 4)");
  f.notes.push_back(
      fmt::format("Scale: the papers state none; here {0} x {0} cells of 1 m, high = {1:.0f} m, "
                  "medium = {2:.0f} m. "
                  "[belhadj2005]'s skeleton is drawn by hand.",
                  kSide, kHigh, kMedium));
  return f;
}

}  // namespace dem::app
