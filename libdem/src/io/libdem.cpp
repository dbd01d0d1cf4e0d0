// The C interface: every function is a library call behind a wall that turns exceptions into a
// status and a line of text.

#include "libdem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>

#include "dem/evaluation.h"
#include "dem/fill.h"
#include "dem/io/methods.h"
#include "dem/io/rasters.h"

struct libdem_dem {
  dem::Dem dem;
  dem::Source source;
  dem::Raster<float> sigma;
};

struct libdem_method {
  dem::ChosenMethod chosen;
};

namespace {

libdem_status fail(libdem_status status, const char* text, libdem_error* error) noexcept {
  if (error) {
    const std::size_t length = std::min(std::strlen(text), sizeof error->text - 1);
    std::memcpy(error->text, text, length);
    error->text[length] = '\0';
    std::replace(error->text, error->text + length, '\n', ' ');
  }
  return status;
}

/// Runs `work`; no exception gets past.
template <class Work>
libdem_status guarded(libdem_error* error, const Work& work) noexcept {
  if (error) error->text[0] = '\0';
  try {
    work();
    return LIBDEM_OK;
  } catch (const std::invalid_argument& e) {
    return fail(LIBDEM_INVALID, e.what(), error);
  } catch (const dem::IoError& e) {
    return fail(LIBDEM_FILE, e.what(), error);
  } catch (const dem::Cancelled& e) {
    return fail(LIBDEM_CANCELLED, e.what(), error);
  } catch (const std::bad_alloc&) {
    return fail(LIBDEM_MEMORY, "not enough memory", error);
  } catch (const std::length_error&) {
    return fail(LIBDEM_MEMORY, "not enough memory", error);
  } catch (const std::exception& e) {
    return fail(LIBDEM_FAILED, e.what(), error);
  } catch (...) {
    return fail(LIBDEM_FAILED, "unknown failure", error);
  }
}

/// The same for a function that makes something: `out` holds what `work` makes, or NULL.
template <class Handle, class Work>
libdem_status making(Handle** out, libdem_error* error, const Work& work) noexcept {
  if (out) *out = nullptr;
  return guarded(error, [&] {
    if (!out) throw std::invalid_argument("out = NULL; must point to where the result goes");
    *out = work().release();
  });
}

/// What `pointer` points to.
template <class T>
T& given(T* pointer, const char* name) {
  if (!pointer) throw std::invalid_argument(fmt::format("{} = NULL; must be given", name));
  return *pointer;
}

void check_lengths(int cols, int rows, double dx_m, double dy_m) {
  for (const auto& [name, n] : {std::pair{"cols", cols}, {"rows", rows}})
    if (n < 1) throw std::invalid_argument(fmt::format("{} = {}; must be at least 1", name, n));
  for (const auto& [name, d] : {std::pair{"dx_m", dx_m}, {"dy_m", dy_m}})
    if (!(d > 0) || !std::isfinite(d))
      throw std::invalid_argument(fmt::format("{} = {}; must be metres above 0", name, d));
}

std::unique_ptr<libdem_dem> make_dem(const float* heights, const std::uint8_t* known,
                                     dem::Size size, dem::Spacing spacing) {
  auto made = std::make_unique<libdem_dem>();
  made->dem = {dem::Raster<float>(size), dem::Mask(size), {}, spacing};
  made->dem.ref.to_world = {0, spacing.dx_m, 0, 0, 0, -spacing.dy_m};
  const auto z = made->dem.z.cells();
  const auto mask = made->dem.known.cells();
  for (std::size_t i = 0; i < z.size(); ++i) {
    const bool finite = std::isfinite(heights[i]);
    mask[i] = known ? known[i] != 0 : finite;
    if (mask[i] && !finite)
      throw std::invalid_argument(
          fmt::format("heights[{}] = {}; must be finite where known is not 0", i, heights[i]));
    if (mask[i]) z[i] = heights[i];
  }
  return made;
}

/// The table of methods, or an empty one when there is no memory to make it.
std::span<const dem::FillMethod> methods() noexcept {
  std::span<const dem::FillMethod> table;
  guarded(nullptr, [&] { table = dem::all_fill_methods(); });
  return table;
}

dem::ChosenMethod choose(const char* name) {
  return dem::find_method(dem::all_fill_methods(), name ? name : dem::default_fill_method());
}

/// Limits of 0 are none.
dem::HoleChoice holes_of(const libdem_choice& choice) {
  dem::HoleChoice holes;
  holes.inner_only = choice.inner_only != 0;
  if (choice.max_area_km2 != 0) holes.max_area_km2 = choice.max_area_km2;
  if (choice.max_distance_m != 0) holes.max_distance_m = choice.max_distance_m;
  if (choice.min_cells != 0) holes.min_cells = choice.min_cells;
  if (choice.where) holes.where = choice.where;
  return holes;
}

dem::Run run_of(const libdem_run* run) {
  if (!run) return {};
  if (run->threads < 0)
    throw std::invalid_argument(fmt::format("threads = {}; must be >= 0", run->threads));
  dem::Run made{run->threads, {}};
  if (run->progress)
    made.progress = [call = run->progress, user = run->user](double part, std::string_view what) {
      return call(part, std::string(what).c_str(), user) != 0;
    };
  return made;
}

}  // namespace

const char* libdem_version(void) { return DEM_VERSION; }

libdem_status libdem_create(const float* heights, const uint8_t* known, int cols, int rows,
                            double dx_m, double dy_m, libdem_dem** dem, libdem_error* error) {
  return making(dem, error, [&] {
    check_lengths(cols, rows, dx_m, dy_m);
    return make_dem(&given(heights, "heights"), known, {cols, rows}, {dx_m, dy_m});
  });
}

libdem_status libdem_read(const char* path, libdem_dem** dem, libdem_error* error) {
  return making(dem, error, [&] {
    dem::DemFile file = dem::read_dem(&given(path, "path"));
    return std::unique_ptr<libdem_dem>(
        new libdem_dem{std::move(file.dem), std::move(file.source), {}});
  });
}

libdem_status libdem_write(const libdem_dem* dem, const char* path, int overwrite,
                           libdem_error* error) {
  return guarded(error, [&] {
    dem::WriteOptions options;
    options.overwrite = overwrite != 0;
    dem::write_dem(&given(path, "path"), given(dem, "dem").dem, dem->source, options);
  });
}

libdem_status libdem_write_sigma(const libdem_dem* dem, const char* path, int overwrite,
                                 libdem_error* error) {
  return guarded(error, [&] {
    if (given(dem, "dem").sigma.empty())
      throw std::invalid_argument("dem has no sigma; it must be filled with sigma = law");
    dem::Source source;
    source.node_registered = dem->source.node_registered;
    source.band_description = "standard deviation of the elevation in metres";
    dem::WriteOptions options;
    options.overwrite = overwrite != 0;
    const dem::Dem layer{dem->sigma, dem->dem.known, dem->dem.ref, dem->dem.spacing};
    dem::write_dem(&given(path, "path"), layer, source, options);
  });
}

void libdem_free(libdem_dem* dem) { delete dem; }

int libdem_cols(const libdem_dem* dem) { return dem ? dem->dem.z.cols() : 0; }
int libdem_rows(const libdem_dem* dem) { return dem ? dem->dem.z.rows() : 0; }
double libdem_dx_m(const libdem_dem* dem) { return dem ? dem->dem.spacing.dx_m : 0; }
double libdem_dy_m(const libdem_dem* dem) { return dem ? dem->dem.spacing.dy_m : 0; }

const float* libdem_heights(const libdem_dem* dem) {
  return dem ? dem->dem.z.cells().data() : nullptr;
}

const uint8_t* libdem_known(const libdem_dem* dem) {
  return dem ? dem->dem.known.cells().data() : nullptr;
}

const float* libdem_sigma(const libdem_dem* dem) {
  return dem && !dem->sigma.empty() ? dem->sigma.cells().data() : nullptr;
}

size_t libdem_method_count(void) { return methods().size(); }

const char* libdem_method_name(size_t number) {
  return number < methods().size() ? methods()[number].name.c_str() : nullptr;
}

const char* libdem_method_summary(size_t number) {
  return number < methods().size() ? methods()[number].summary.c_str() : nullptr;
}

libdem_status libdem_choose(const char* name, libdem_method** method, libdem_error* error) {
  return making(method, error,
                [&] { return std::unique_ptr<libdem_method>(new libdem_method{choose(name)}); });
}

size_t libdem_setting_count(const libdem_method* method) {
  return method ? method->chosen.method->fields.size() : 0;
}

libdem_status libdem_setting_at(const libdem_method* method, size_t number, libdem_setting* setting,
                                libdem_error* error) {
  return guarded(error, [&] {
    const auto& fields = given(method, "method").chosen.method->fields;
    if (number >= fields.size())
      throw std::invalid_argument(
          fmt::format("number = {}; must be below {}", number, fields.size()));
    const dem::FieldInfo& f = fields[number];
    given(setting, "setting") = {f.name.c_str(),  f.type.c_str(),         f.unit.c_str(),
                                 f.range.c_str(), f.default_text.c_str(), f.doc.c_str()};
  });
}

libdem_status libdem_set(libdem_method* method, const char* name, const char* value,
                         libdem_error* error) {
  return guarded(error, [&] {
    dem::ChosenMethod changed = given(method, "method").chosen;
    changed.settings.emplace_back(&given(name, "name"), &given(value, "value"));
    changed.check();
    method->chosen = std::move(changed);
  });
}

void libdem_free_method(libdem_method* method) { delete method; }

libdem_status libdem_fill(const libdem_dem* dem, const libdem_method* method,
                          const libdem_choice* choice, const libdem_run* run, libdem_dem** filled,
                          libdem_error* error) {
  return making(filled, error, [&] {
    const libdem_dem& holes = given(dem, "dem");
    dem::FillOptions options;
    if (method) options.method = method->chosen;
    if (choice) {
      options.holes = holes_of(*choice);
      options.whole = choice->whole != 0;
    }
    dem::HoleFill result = dem::fill_holes(holes.dem, options, {}, run_of(run));
    return std::unique_ptr<libdem_dem>(
        new libdem_dem{std::move(result.dem), holes.source, std::move(result.sigma)});
  });
}

libdem_status libdem_evaluate(const libdem_dem* truth, const libdem_dem* got,
                              const libdem_dem* sampled, libdem_errors* errors,
                              libdem_error* error) {
  return guarded(error, [&] {
    libdem_errors& out = given(errors, "errors");
    const dem::Evaluation evaluation = dem::evaluate_dem(
        given(truth, "truth").dem, given(got, "got").dem, {sampled ? &sampled->dem : nullptr});
    const dem::Errors& e = evaluation.judged_errors();
    out = {e.cells, e.rmse_m, e.mae_m, e.bias_m, e.nmad_m, e.le90_m, e.max_m, e.slope_rmse_deg};
  });
}
