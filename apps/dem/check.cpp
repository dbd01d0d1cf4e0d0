// dem check: do the tiles of a folder agree on the edges that they share?

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "verbs.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

struct Options {
  std::string folder;
  ReadOptions read;
};

/// One side of a tile: its heights, NaN where unknown, and where its first and last cell lie.
struct Edge {
  std::vector<float> z;
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Tile {
  std::string name;
  Edge north, south, west, east;
  double cell = 0;  // in CRS units
};

Edge edge_of(const Dem& dem, int col, int row, int to_col, int to_row) {
  Edge edge;
  const int dc = to_col > col ? 1 : 0, dr = to_row > row ? 1 : 0;
  const int n = std::max(to_col - col, to_row - row) + 1;
  for (int i = 0; i < n; ++i) {
    const int c = col + dc * i, r = row + dr * i;
    edge.z.push_back(dem.known(c, r) ? dem.z(c, r) : NAN);
  }
  const auto& at = dem.ref.to_world;
  edge.x0 = at[0] + at[1] * col + at[2] * row;
  edge.y0 = at[3] + at[4] * col + at[5] * row;
  edge.x1 = at[0] + at[1] * to_col + at[2] * to_row;
  edge.y1 = at[3] + at[4] * to_col + at[5] * to_row;
  return edge;
}

Tile tile_of(const std::string& name, const Dem& dem) {
  const int right = dem.size().cols - 1, bottom = dem.size().rows - 1;
  return {name,
          edge_of(dem, 0, 0, right, 0),
          edge_of(dem, 0, bottom, right, bottom),
          edge_of(dem, 0, 0, 0, bottom),
          edge_of(dem, right, 0, right, bottom),
          std::min(std::hypot(dem.ref.to_world[1], dem.ref.to_world[4]),
                   std::hypot(dem.ref.to_world[2], dem.ref.to_world[5]))};
}

struct Seam {
  std::string first, second, side;
  std::size_t cells = 0, differ = 0, one_unknown = 0;
  double worst_m = 0;
};

/// Compares two edges when they are the same cells.
void compare(const Tile& a, const Edge& of_a, const Tile& b, const Edge& of_b, const char* side,
             std::vector<Seam>& seams) {
  const double slack = 0.01 * std::min(a.cell, b.cell);
  const bool same = of_a.z.size() == of_b.z.size() && std::abs(of_a.x0 - of_b.x0) < slack &&
                    std::abs(of_a.y0 - of_b.y0) < slack && std::abs(of_a.x1 - of_b.x1) < slack &&
                    std::abs(of_a.y1 - of_b.y1) < slack;
  if (!same) return;
  Seam seam{a.name, b.name, side, of_a.z.size(), 0, 0, 0};
  for (std::size_t i = 0; i < of_a.z.size(); ++i) {
    const double difference = std::abs(double(of_a.z[i]) - double(of_b.z[i]));
    seam.one_unknown += std::isnan(of_a.z[i]) != std::isnan(of_b.z[i]);
    if (!(difference > 0)) continue;
    ++seam.differ;
    seam.worst_m = std::max(seam.worst_m, difference);
  }
  seams.push_back(seam);
}

std::vector<Tile> read_tiles(const Options& options, const Run& run) {
  const std::vector<std::string> paths = tiles_in(options.folder);
  std::vector<Tile> tiles;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    run.report(double(i) / double(paths.size()), "reading tiles");
    tiles.push_back(tile_of(fs::path(paths[i]).filename().string(),
                            read_dem(paths[i], options.read, {run.threads, {}}).dem));
  }
  return tiles;
}

int check_tiles(const Options& options, Shell& shell) {
  const Run run = shell.run();
  const std::vector<Tile> tiles = read_tiles(options, run);
  std::vector<Seam> seams;
  for (const Tile& a : tiles)
    for (const Tile& b : tiles) {
      compare(a, a.east, b, b.west, "east", seams);
      compare(a, a.south, b, b.north, "south", seams);
    }

  Json list = Json::array();
  std::string text;
  std::size_t bad = 0;
  for (const Seam& seam : seams) {
    list.push_back({{"first", seam.first},
                    {"second", seam.second},
                    {"side", seam.side},
                    {"cells", seam.cells},
                    {"differ", seam.differ},
                    {"one_unknown", seam.one_unknown},
                    {"worst_m", seam.worst_m}});
    if (seam.differ + seam.one_unknown == 0) continue;
    ++bad;
    text += fmt::format(
        "{} and {} to its {}: {} of {} shared cells differ, by up to {:.6g} m; {} known in one "
        "only\n",
        seam.first, seam.second, seam.side, grouped(seam.differ), grouped(seam.cells), seam.worst_m,
        grouped(seam.one_unknown));
  }
  text += fmt::format("{} tiles, {} shared edges, {} with differences\n", tiles.size(),
                      seams.size(), bad);
  shell.print({{"tiles", tiles.size()}, {"edges", list}, {"bad_edges", bad}}, text);
  return bad > 0 ? kCheckFailed : kDone;
}

}  // namespace

void add_check(Program& program, Shell& shell) {
  const auto options = std::make_shared<Options>();
  Command& verb = program.add("check", kEveryday,
                              "Compare the shared edges of the tiles in a folder (exit code 4 when "
                              "they differ)",
                              "  dem check tiles/\n"
                              "  dem check tiles/ --json");
  verb.work = [options, &shell] { return check_tiles(*options, shell); };
  verb.argument("DIR", options->folder, "Folder of .hgt or .tif tiles that share their edges")
      .kind("folder")
      .must_be_given();
  add_read_options(verb, options->read);
}

}  // namespace dem::app
