// The turtle that walks an L-system.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "dem/sketch.h"
#include "synthesis/paths.h"

namespace dem {
using namespace synthesis;
namespace {

struct Turtle {
  Point at;
  double heading;    // in turns
  double scale = 1;  // length of its lines
  bool mirrored = false;
};

/// Walks a system and calls line(from, to, scale) for each F.
template <class Line>
class Walk {
 public:
  Walk(const LSystem& system, double finest, Line line)
      : system_(system), finest_(finest), line_(line) {}

  void start(int rewrites) {
    Turtle turtle{{0, 0}, system_.start};
    read(system_.axiom, rewrites, turtle);
  }

 private:
  const std::string* rule(char symbol) const {
    const auto found =
        std::ranges::find(system_.rules, symbol, &std::pair<char, std::string>::first);
    return found == system_.rules.end() ? nullptr : &found->second;
  }

  /// Reads the symbols of a word; those with a rule stand for their word `rewrites` times over.
  void read(std::string_view word, int rewrites, Turtle& turtle) {
    std::vector<Turtle> kept;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const char symbol = word[i];
      if (const auto* next = rule(symbol)) {
        if (rewrites > 0 && turtle.scale > finest_) read(*next, rewrites - 1, turtle);
        continue;
      }
      const double left = turtle.mirrored ? -system_.angle : system_.angle;
      switch (symbol) {
        case 'F':
          forward(turtle);
          break;
        case '+':
          turtle.heading += left;
          break;
        case '-':
          turtle.heading -= left;
          break;
        case '!':
          turtle.mirrored = !turtle.mirrored;
          break;
        case '@': {
          double factor = 0;
          const char* end = word.data() + word.size();
          const auto number = std::from_chars(word.data() + i + 1, end, factor);
          if (number.ec != std::errc() || !(factor > 0))
            throw std::invalid_argument(
                fmt::format("L-system \"{}\": @ at {} needs a number above 0", word, i + 1));
          turtle.scale *= factor;
          i = std::size_t(number.ptr - word.data()) - 1;
          break;
        }
        case '[':
          kept.push_back(turtle);
          break;
        case ']':
          if (kept.empty()) fail_brackets(word);
          turtle = kept.back();
          kept.pop_back();
          break;
        default:
          break;  // a symbol that only rewrites
      }
    }
    if (!kept.empty()) fail_brackets(word);
  }

  void forward(Turtle& turtle) {
    const double angle = 2 * std::numbers::pi * turtle.heading;
    const Point from = turtle.at;
    turtle.at = from + turtle.scale * Point{std::cos(angle), -std::sin(angle)};
    line_(from, turtle.at, turtle.scale);
  }

  [[noreturn]] static void fail_brackets(std::string_view word) {
    throw std::invalid_argument(fmt::format("L-system \"{}\": [ and ] do not match", word));
  }

  const LSystem& system_;
  double finest_;
  Line line_;
};

template <class Line>
void walk(const LSystem& system, int rewrites, double finest, Line line) {
  Walk<Line>(system, finest, line).start(rewrites);
}

}  // namespace

std::vector<Field> fields(LSystemOptions& o) {
  std::vector<Field> list{
      {"rewrites", o.rewrites, {0, 20}, "", "how many times the system is rewritten"},
      {"low_m", o.low_m, {-20000, 20000}, "m", "height of the finest lines"},
      {"high_m", o.high_m, {-20000, 20000}, "m", "height of the longest lines"},
      {"margin", o.margin, {0, 0.45}, "", "free room on each side, as part of the map"},
  };
  for (auto& field : fields(o.mcmd)) list.push_back(std::move(field));
  return list;
}

Dem draw_lsystem(Size size, Spacing spacing, const LSystem& system, const LSystemOptions& o) {
  check_options(o);
  check_map(size, spacing, 2, "an L-system");

  // Its extent, with lines of length 1.
  constexpr double inf = std::numeric_limits<double>::infinity();
  Point low{inf, inf}, high{-inf, -inf};
  walk(system, o.rewrites, 1e-3, [&](Point a, Point b, double) {
    low = {std::min({low.x, a.x, b.x}), std::min({low.y, a.y, b.y})};
    high = {std::max({high.x, a.x, b.x}), std::max({high.y, a.y, b.y})};
  });
  const Point extent = high - low;
  if (!(std::max(extent.x, extent.y) > 0))
    throw std::invalid_argument(
        fmt::format("rewrites = {}: the L-system draws nothing; must be more", o.rewrites));

  const double room = 1 - 2 * o.margin;
  const double scale = std::min(room * (size.cols - 1) * spacing.dx_m / std::max(extent.x, 1e-9),
                                room * (size.rows - 1) * spacing.dy_m / std::max(extent.y, 1e-9));
  const Point middle{(size.cols - 1) * spacing.dx_m / 2, (size.rows - 1) * spacing.dy_m / 2};
  const auto cell_at = [&](Point p) {
    const Point q = middle + scale * (p - 0.5 * (low + high));
    return Cell{int(std::lround(q.x / spacing.dx_m)), int(std::lround(q.y / spacing.dy_m))};
  };

  Dem dem{Raster<float>(size), Mask(size), {}, spacing};
  const double finest = std::max(1e-3, std::min(spacing.dx_m, spacing.dy_m) / scale / 3);
  walk(system, o.rewrites, finest, [&](Point a, Point b, double length) {
    const auto height = float(std::lerp(o.low_m, o.high_m, std::min(1.0, std::sqrt(length))));
    const auto mark = [&](Cell c) {
      if (!dem.z.contains(c.col, c.row)) return true;
      float& z = dem.z(c.col, c.row);
      z = dem.known(c.col, c.row) ? std::max(z, height) : height;
      dem.known(c.col, c.row) = 1;
      return true;
    };
    mark(cell_at(a));
    walk_line(cell_at(a), cell_at(b), mark);
  });
  return dem;
}

Raster<float> generate_lsystem(const Canvas& canvas, const LSystemOptions& o, const Run& run) {
  return fill_mcmd(draw_lsystem(canvas.size, canvas.spacing, {}, o), o.mcmd, run);
}

}  // namespace dem
