#include "dem/spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dem/breaklines.h"
#include "dem/mcmd.h"
#include "numeric/distance.h"
#include "numeric/parallel.h"
#include "spline/overshoot.h"
#include "spline/roughness.h"
#include "spline/spline_parameters.h"
#include "spline/spline_sample.h"
#include "spline/spline_solver.h"

namespace dem {
using namespace numeric;
using namespace spline;
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

// ---- The plane under the terrain

/// Height mean_m + slope_x (col - centre_x) + slope_y (row - centre_y).
struct Plane {
  double mean_m = 0, slope_x = 0, slope_y = 0, centre_x = 0, centre_y = 0;
  double at(int col, int row) const {
    return mean_m + slope_x * (col - centre_x) + slope_y * (row - centre_y);
  }
};

/// Calls each(col, row, z) for every known cell.
template <class Each>
void for_known(const Dem& dem, const Each& each) {
  for (int y = 0; y < dem.size().rows; ++y) {
    const auto known = dem.known.row(y);
    const auto z = dem.z.row(y);
    for (int x = 0; x < dem.size().cols; ++x)
      if (known[std::size_t(x)]) each(x, y, double(z[std::size_t(x)]));
  }
}

/// The plane that the membrane pulls to: the least-squares plane of the known cells as far as they
/// are one. Its slopes shrink with R^2, the part of the variance that it explains, from whole at 1
/// to none at 0.5: else a mountain on one side of a basin would tilt the basin. Cells on a line
/// leave the slope across it open: 0.
Plane fit_plane(const Dem& dem) {
  double n = 0, x_sum = 0, y_sum = 0, z_sum = 0;
  for_known(dem, [&](int x, int y, double z) {
    ++n;
    x_sum += x;
    y_sum += y;
    z_sum += z;
  });
  Plane plane{z_sum / n, 0, 0, x_sum / n, y_sum / n};
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
  for_known(dem, [&](int col, int row, double z) {
    const double x = col - plane.centre_x, y = row - plane.centre_y, h = z - plane.mean_m;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    xz += x * h;
    yz += y * h;
    zz += h * h;
  });
  // Pseudo-inverse of the 2 x 2 matrix through its eigenvectors (ux, uy).
  const double half = (xx - yy) / 2, radius = std::hypot(half, xy), middle = (xx + yy) / 2;
  const double angle = std::atan2(xy, half) / 2;
  for (const double sign : {1., -1.}) {
    const double eigenvalue = middle + sign * radius;
    if (eigenvalue <= 1e-9 * (middle + radius)) continue;
    const double ux = sign > 0 ? std::cos(angle) : -std::sin(angle);
    const double uy = sign > 0 ? std::sin(angle) : std::cos(angle);
    const double along = (ux * xz + uy * yz) / eigenvalue;
    plane.slope_x += along * ux;
    plane.slope_y += along * uy;
  }
  const double explained = zz > 0 ? (plane.slope_x * xz + plane.slope_y * yz) / zz : 0;
  const double kept = std::clamp(2 * explained - 1, 0.0, 1.0);
  plane.slope_x *= kept;
  plane.slope_y *= kept;
  return plane;
}

// ---- The energy

/// Where the options leave the energy blind to constants (no membrane), a membrane a thousand times
/// longer than the DEM holds what the data do not.
Springs springs_of(const SplineOptions& options, double X, Size size) {
  const double diagonal = std::hypot(size.cols / std::sqrt(X), size.rows);
  const double L1 = options.L1_rows > 0 ? options.L1_rows : 1000 * diagonal;
  const double a1 = std::pow(two_pi / L1, 2), a3 = std::pow(options.L3_rows / two_pi, 2);
  return terrain_springs(a1, options.a2, a3, X, options.fourth_order);
}

double squared_aspect(Spacing spacing) {
  if (!(spacing.dx_m > 0) || !(spacing.dy_m > 0) || !std::isfinite(spacing.dx_m / spacing.dy_m))
    throw std::invalid_argument(fmt::format("spacing = {} x {} m; both must be positive numbers",
                                            spacing.dx_m, spacing.dy_m));
  return std::pow(spacing.dy_m / spacing.dx_m, 2);
}

// ---- The start

/// The DEM with the plane taken off.
Dem detrended(const Dem& dem, const Plane& plane) {
  Dem flat = dem;
  parallel_for(0, dem.size().rows, 32, [&](int y) {
    const auto z = flat.z.row(y);
    for (int x = 0; x < dem.size().cols; ++x)
      z[std::size_t(x)] = dem.known(x, y) ? float(double(z[std::size_t(x)]) - plane.at(x, y)) : 0;
  });
  return flat;
}

/// Heights above the plane: exact at known cells, the start elsewhere. `flat`: the DEM without its
/// plane.
Grid<double> above_plane(const Dem& dem, const Dem& flat, const Plane& plane, const Run& run) {
  const Raster<float> start = fill_mcmd(flat, {}, run);
  Grid<double> x(dem.size());
  parallel_for(0, dem.size().rows, 32, [&](int row) {
    for (int col = 0; col < dem.size().cols; ++col)
      x.row(row)[col] = dem.known(col, row) ? double(dem.z(col, row)) - plane.at(col, row)
                                            : double(start(col, row));
  });
  return x;
}

// ---- Data that are met, and data that pull

struct Data {
  Mask free;      ///< cells to solve for
  Grid<float> w;  ///< 1 / (nugget * noise) at known cells that pull; empty: all are met
  Grid<float> f;  ///< w * height above the plane
};

Data make_data(const Dem& dem, const Raster<float>& noise, double nugget, const Grid<double>& x) {
  Data data{Mask(dem.size()), {}, {}};
  const Mask closed = cells_closed_off(dem.known, dem.breaks);  // nothing says anything of them
  if (nugget > 0) {
    data.w = Grid<float>(dem.size());
    data.f = Grid<float>(dem.size());
  }
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col) {
      const double variance = noise.empty() ? nugget : nugget * double(noise(col, row));
      if (!dem.known(col, row)) {
        data.free(col, row) = !closed(col, row);
      } else if (variance > 0) {
        data.free(col, row) = 1;
        data.w.row(row)[col] = float(1 / variance);
        data.f.row(row)[col] = float(x.row(row)[col] / variance);
      }
    }
  return data;
}

/// How far around a cell its bending is read: the mean distance between known cells; beside gaps,
/// three cells.
double adaptive_sigma(const Dem& dem, const SplineOptions& options, Layout layout) {
  if (options.adaptive_sigma_cells > 0) return options.adaptive_sigma_cells;
  if (layout == Layout::contours) return 1.5;
  if (layout == Layout::clustered) return 3;
  const double density = double(count(dem.known)) / double(dem.size().cells());
  return std::clamp(1 / std::sqrt(density), 0.8, 16.);
}

bool all_whole_metres(const Dem& dem) {
  bool whole = true;
  for_known(dem, [&](int, int, double z) { whole = whole && z == std::floor(z); });
  return whole;
}

// ---- Uncertainty

/// Random surfaces that are 0 at the data, in units of the springs' scale.
class Simulation {
 public:
  Simulation(SplineSolver& solver, const Springs& springs, std::uint64_t seed)
      : solver_(solver), springs_(springs), seed_(seed) {}

  Grid<double> draw(int index, const Run& run) {
    const Level& level = solver_.finest();
    const Grid<float> f = spring_noise(springs_, level.breaks, level.size, level.w, seed_, index);
    Grid<double> d(level.size);
    solver_.solve(d, &f, {0, 0.03, 100}, run);
    return d;
  }

 private:
  SplineSolver& solver_;
  const Springs& springs_;
  std::uint64_t seed_;
};

/// The scale of the springs: E(z) = n s^2 for a surface drawn from them and met at n cells.
double spring_scale(const Springs& springs, const Grid<double>& x, const Dem& dem) {
  return std::sqrt(spring_energy(springs, dem.breaks, x) / double(count(dem.known)));
}

/// Standard deviations of the filled cells.
struct Uncertainty {
  double scale = 1;     ///< of the springs
  double rounding = 0;  ///< variance of whole metres
  double contour_step = 0;
  Roughness roughness;
  DistanceLaw law;

  /// The springs' scale at a cell.
  double scale_at(int col, int row) const { return scale * roughness.at(col, row); }

  /// From a variance in units of the springs' scale.
  double sigma(double variance, int col, int row) const {
    const double local = scale_at(col, row);
    return std::sqrt(local * local * variance + rounding);
  }

  /// From the distance to data, in fifths of a cell. Between contour lines the data say more than
  /// springs do: about a fifth of the step (seven terrains).
  double sigma_by_distance(double fifths, int col, int row) const {
    if (contour_step > 0) return 0.22 * contour_step * std::min(1., fifths / 8);
    return sigma(law.variance(fifths), col, row);
  }
};

/// Widens or narrows the scale until `part` of the hidden cells lie within one sigma. Returns the
/// parts within one and two.
std::pair<double, double> calibrate(Uncertainty& u, const std::vector<HeldOut>& cells,
                                    double part) {
  if (cells.empty()) return {0, 0};
  const auto sigmas = [&](const HeldOut& c) {
    return std::abs(double(c.error_m)) / u.sigma_by_distance(c.distance, c.col, c.row);
  };
  std::vector<double> ratio;
  for (const HeldOut& c : cells) ratio.push_back(sigmas(c));
  const auto at = ratio.begin() + std::ptrdiff_t(part * double(ratio.size()));
  std::ranges::nth_element(ratio, at);
  u.scale *= std::max(*at, 0.05);
  double one = 0, two = 0;
  for (const HeldOut& c : cells) {
    one += sigmas(c) <= 1;
    two += sigmas(c) <= 2;
  }
  return {one / double(cells.size()), two / double(cells.size())};
}

/// By default the solve's own error adds well under 1 % to the RMSE: 5 % of the error of the hidden
/// cells, or 3 % of the change made where no cell was hidden.
SolveLimits limits_of(const SplineOptions& options, const ChosenSprings& chosen) {
  if (options.tolerance_m > 0) return {options.tolerance_m, 0, options.max_iterations};
  if (chosen.hidden_rmse_m > 0) return {0.05 * chosen.hidden_rmse_m, 0.01, options.max_iterations};
  return {0, 0.05, options.max_iterations};
}

SolveLimits coarser(SolveLimits limits, double times) {
  limits.tolerance_m *= times;
  limits.relative_tolerance *= times;
  return limits;
}

/// Sigma and the realisation asked for: the latter is added to x.
void sample(const Dem& dem, const SplineOptions& options, const ChosenSprings& chosen,
            const Springs& springs, SplineSolver& solver, Grid<double>& x, SplineFilled& filled,
            const Run& run) {
  Simulation simulation(solver, springs, options.seed);
  const auto distance = chamfer_distances(dem.known);
  Uncertainty uncertainty{spring_scale(springs, x, dem),
                          all_whole_metres(dem) ? 1 / 12. : 0,
                          chosen.contour_step_m,
                          Roughness(x, dem.known, dem.breaks, squared_aspect(dem.spacing), {}),
                          {}};

  const bool simulate = options.sigma == SplineSigma::simulation;
  const int draws = simulate ? options.realisations : 2;
  Raster<float> squares(simulate ? dem.size() : Size{});
  for (int k = 1; k <= draws; ++k) {
    const Grid<double> d = simulation.draw(k, run.part((k - 1.) / draws, double(k) / draws));
    uncertainty.law.add(d, distance);
    if (simulate)
      parallel_for(0, dem.size().rows, 32, [&](int row) {
        for (int col = 0; col < dem.size().cols; ++col)
          squares(col, row) += float(d.row(row)[col] * d.row(row)[col]);
      });
  }
  uncertainty.law.finish();
  // A little above 0.68: what must be filled is harder than what could be hidden, most of all in a
  // small window.
  const auto [one, two] = calibrate(uncertainty, chosen.held_out, chosen.as_usual ? 0.79 : 0.72);
  filled.scale_m = uncertainty.scale;
  filled.report.push_back({"scale", uncertainty.scale, "m"});
  filled.report.push_back({"inside_1_sigma", one, ""});
  filled.report.push_back({"inside_2_sigma", two, ""});

  if (options.sigma != SplineSigma::none) {
    filled.sigma = Raster<float>(dem.size());
    parallel_for(0, dem.size().rows, 32, [&](int row) {
      for (int col = 0; col < dem.size().cols; ++col) {
        if (dem.known(col, row)) continue;
        filled.sigma(col, row) =
            float(simulate ? uncertainty.sigma(double(squares(col, row)) / draws, col, row)
                           : uncertainty.sigma_by_distance(distance(col, row), col, row));
      }
    });
  }
  if (options.realisation > 0) {
    const Grid<double> d = simulation.draw(options.realisation, run);
    for (int row = 0; row < dem.size().rows; ++row)
      for (int col = 0; col < dem.size().cols; ++col)
        if (!dem.known(col, row))
          x.row(row)[col] += options.roughness * uncertainty.scale_at(col, row) * d.row(row)[col];
  }
}

/// Shortens L1 while the springs shoot over the gaps. Hidden cells cannot tell: where only the
/// steep cells are known, those beside the gaps are steep too, and the gaps are flat.
void soften_overshooting(SplineOptions& options, const Dem& dem, const Raster<float>& noise,
                         double X, const Grid<double>& start, const Raster<std::uint16_t>& distance,
                         const Run& run) {
  constexpr double most = 0.16, shortest_rows = 4;
  const SolveLimits rough{0, 0.05, options.max_iterations};
  Data data = make_data(dem, noise, options.nugget, start);
  while (options.L1_rows == 0 || options.L1_rows > shortest_rows) {
    Grid<double> x = start;
    SplineSolver solver(springs_of(options, X, dem.size()), X, data.free, data.w, dem.breaks);
    solver.solve(x, data.f.empty() ? nullptr : &data.f, rough, run);
    if (overshoot(x, dem.known, distance) <= most) return;
    options.L1_rows = options.L1_rows == 0 ? 128 : options.L1_rows / 2;
  }
}

SplineFilled solve(const Dem& dem, const Raster<float>& noise, SplineOptions options,
                   const Run& run) {
  const double X = squared_aspect(dem.spacing);
  const Plane plane = fit_plane(dem);
  ChosenSprings chosen;
  Raster<std::uint16_t> distance;
  Grid<double> x;
  {
    const Dem flat = detrended(dem, plane);
    x = above_plane(dem, flat, plane, run.part(0, 0.05));
    if (options.parameters == SplineParameters::automatic || options.adaptive) {
      distance = chamfer_distances(dem.known);
      chosen.layout = layout_of(dem, distance);
      if (options.parameters == SplineParameters::automatic)
        chosen = choose_springs(flat, chosen.layout, distance, X,
                                options.sigma != SplineSigma::none || options.realisation > 0,
                                run.part(0.05, 0.4));
    }
  }
  if (options.parameters == SplineParameters::automatic) {
    options.L1_rows = chosen.L1_rows;
    options.L3_rows = chosen.L3_rows;
    options.fourth_order = chosen.fourth_order;
    if (options.nugget == 0) options.nugget = chosen.nugget;
    if (chosen.layout != Layout::scattered && !chosen.as_usual)
      soften_overshooting(options, dem, noise, X, x, distance, run.part(0.3, 0.3));
  }
  distance = {};

  Solved solved;
  SplineFilled filled;
  const Springs springs = springs_of(options, X, dem.size());
  {
    Data data = make_data(dem, noise, options.nugget, x);
    SplineSolver solver(springs, X, data.free, std::move(data.w), dem.breaks);
    const Grid<float>* f = data.f.empty() ? nullptr : &data.f;
    // Beside breaklines the start is far off, in few cells: they need more than the RMS tells.
    const SolveLimits limits = coarser(limits_of(options, chosen), dem.breaks.empty() ? 1 : 0.2);
    if (!options.adaptive) {
      solved = solver.solve(x, f, limits, run.part(0.4, 1));
    } else {
      // Plain springs first; then twice the weights of the surface so far, and on from there.
      SolveLimits rough = limits;
      rough.relative_tolerance = 0.1;
      rough.tolerance_m = 0;
      solved = solver.solve(x, f, rough, run.part(0.4, 0.6));
      const SolveLimits fine{
          std::max(limits.tolerance_m, limits.relative_tolerance * solved.change_m), 0,
          options.max_iterations};
      Tensor tensor(dem.size(), solver.finest().spans, X, dem.breaks);
      solver.bend_with(&tensor);
      for (const double part : {0.6, 0.8}) {
        tensor.estimate(x, adaptive_sigma(dem, options, chosen.layout));
        const int before = solved.iterations;
        solved =
            solver.solve(x, f, part < 0.7 ? coarser(fine, 3) : fine, run.part(part, part + 0.2));
        solved.iterations += before;
      }
      solver.bend_with(nullptr);
    }
    if (options.sigma != SplineSigma::none || options.realisation > 0)
      sample(dem, options, chosen, springs, solver, x, filled, run.part(0.9, 1));
  }

  filled.z = Raster<float>(dem.size());
  parallel_for(0, dem.size().rows, 32, [&](int row) {
    for (int col = 0; col < dem.size().cols; ++col)
      filled.z(col, row) = dem.known(col, row) && !options.smooth_known
                               ? dem.z(col, row)
                               : float(x.row(row)[col] + plane.at(col, row));
  });
  filled.L1_rows = options.L1_rows;
  filled.L3_rows = options.L3_rows;
  filled.fourth_order = options.fourth_order;
  filled.report.insert(filled.report.begin(), {{"iterations", double(solved.iterations), ""},
                                               {"converged", solved.converged ? 1. : 0., ""},
                                               {"estimated_error", solved.estimated_error_m, "m"},
                                               {"residual", solved.residual_m, "m"},
                                               {"L1", options.L1_rows, "rows"},
                                               {"L3", options.L3_rows, "rows"},
                                               {"fourth_order", options.fourth_order ? 1. : 0., ""},
                                               {"nugget", options.nugget, ""}});
  if (chosen.hidden_cells > 0) {
    filled.report.push_back({"hidden_cells", double(chosen.hidden_cells), ""});
    filled.report.push_back({"hidden_rmse", chosen.hidden_rmse_m, "m"});
  }
  return filled;
}

/// What breaklines close off without data gets the surface that goes on from around, as though
/// there were no lines.
SplineFilled solve_closed_off(const Dem& dem, SplineFilled filled, SplineOptions options,
                              const Run& run) {
  const Mask closed = cells_closed_off(dem.known, dem.breaks);
  const std::size_t cells = count(closed);
  filled.report.push_back({"closed_off", double(cells), ""});
  if (cells == 0) return filled;
  Dem around = dem;
  around.breaks = {};
  around.z = filled.z;
  for (std::size_t i = 0; i < closed.cells().size(); ++i)
    around.known.cells()[i] = !closed.cells()[i];
  options.L1_rows = filled.L1_rows;
  options.L3_rows = filled.L3_rows;
  options.fourth_order = filled.fourth_order;
  options.parameters = SplineParameters::manual;
  options.adaptive = options.smooth_known = false;
  options.nugget = 0;
  const Filled inside = solve(around, {}, options, run);
  for (std::size_t i = 0; i < closed.cells().size(); ++i) {
    if (!closed.cells()[i]) continue;
    filled.z.cells()[i] = inside.z.cells()[i];
    if (!filled.sigma.empty()) filled.sigma.cells()[i] = inside.sigma.cells()[i];
  }
  return filled;
}

}  // namespace

std::vector<Field> fields(SplineOptions& o) {
  return {
      {"parameters",
       o.parameters,
       {"automatic", "manual"},
       "L1 and L3 from the DEM, or as set here"},
      {"L1", o.L1_rows, {0, 1e9}, "rows", "manual: membrane for waves longer than this; 0: none"},
      {"L3",
       o.L3_rows,
       {0, 1000},
       "rows",
       "manual: third order for waves shorter than this; 0: none"},
      {"fourth_order", o.fourth_order,
       "manual: fourth-order accurate wavenumbers; false suits rough ground"},
      {"a2", o.a2, {0, 1e9}, "", "weight of the plate (second order)"},
      {"nugget",
       o.nugget,
       {0, 1e9},
       "",
       "noise variance of the data over the springs' scale; 0: exact"},
      {"smooth_known", o.smooth_known, "with a nugget: known cells return smoothed"},
      {"adaptive", o.adaptive,
       "springs bend with the terrain around: ridges continue through gaps"},
      {"adaptive_sigma",
       o.adaptive_sigma_cells,
       {0, 16},
       "cells",
       "how far around a cell its bending is read; 0: from the density of the data"},
      {"tolerance",
       o.tolerance_m,
       {0, 1e9},
       "m",
       "stop when the estimated RMS error is below; 0: so small that RMSE changes by well under 1 "
       "%"},
      {"max_iterations", o.max_iterations, {1, 100000}, "", "stop after so many iterations"},
      {"sigma",
       o.sigma,
       {"none", "law", "simulation"},
       "standard deviation of each cell: by its distance to data, or by random surfaces"},
      {"realisations",
       o.realisations,
       {2, 1000},
       "",
       "random surfaces that sigma = simulation takes"},
      {"realisation",
       o.realisation,
       {0, 1000000},
       "",
       "return the k-th random surface through the data; 0: the spline itself"},
      {"roughness",
       o.roughness,
       {0, 100},
       "",
       "of a realisation, over that of the terrain around each gap"},
      {"seed", o.seed, "seed of the random surfaces"},
  };
}

void check_settings(const SplineOptions& options) {
  check_options(options);
  const SplineOptions usual;
  if (options.parameters == SplineParameters::automatic &&
      (options.L1_rows != usual.L1_rows || options.L3_rows != usual.L3_rows ||
       options.fourth_order != usual.fourth_order))
    throw std::invalid_argument(
        "L1, L3 and fourth_order are chosen from the DEM; to set them, set parameters = manual");
}

bool gives_sigma(const SplineOptions& options) { return options.sigma != SplineSigma::none; }

SplineFilled fill_spline(const Dem& dem, const SplineOptions& options, const Run& run) {
  return fill_spline(dem, Raster<float>(), options, run);
}

SplineFilled fill_spline(const Dem& dem, const Raster<float>& noise, const SplineOptions& options,
                         const Run& run) {
  check_fillable(dem);
  check_settings(options);
  if (!noise.empty() && noise.size() != dem.size())
    throw std::invalid_argument(fmt::format("noise is {} x {}; must be {} x {} as the dem",
                                            noise.cols(), noise.rows(), dem.size().cols,
                                            dem.size().rows));
  return with_threads(run.threads, [&] {
    if (dem.breaks.empty()) return solve(dem, noise, options, run);
    return solve_closed_off(dem, solve(dem, noise, options, run.part(0, 0.9)), options,
                            run.part(0.9, 1));
  });
}

}  // namespace dem
