#ifndef DEM_LIBDEM_H
#define DEM_LIBDEM_H
/*
 * libdem for C (C99 and later): fill the holes of a DEM, read and write elevation files.
 *
 * It is called libdem.h because dem/dem.h holds the values of the C++ interface. Link dem::io, or
 * what `pkg-config --libs dem` prints.
 *
 *   libdem_dem *holes = NULL, *filled = NULL;
 *   libdem_error error;
 *   if (libdem_read("N36E008.hgt", &holes, &error) ||
 *       libdem_fill(holes, NULL, NULL, NULL, &filled, &error))
 *     fprintf(stderr, "%s\n", error.text);
 *
 * A function stores what it makes through its second to last pointer, and the caller frees it.
 * When a function fails, it returns a value other than LIBDEM_OK, writes one line into `error`
 * (which may be NULL) and stores NULL. No C++ exception leaves these functions. Handles that are
 * only read may be used from several threads at once. Texts are UTF-8 and belong to the library.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum libdem_status {
  LIBDEM_OK = 0,
  LIBDEM_INVALID = 1, /* an argument or a setting; the text names it, its value, what it must be */
  LIBDEM_FILE = 2,    /* a file could not be read or written: path and cause */
  LIBDEM_MEMORY = 3,  /* not enough memory */
  LIBDEM_CANCELLED = 4, /* libdem_run.progress returned 0 */
  LIBDEM_FAILED = 5     /* anything else */
} libdem_status;

/* The error of one call; "" when there was none. A text that is too long is cut. */
typedef struct libdem_error {
  char text[512];
} libdem_error;

/* Heights in metres, the mask of known cells and their places; after a fill, also sigma. */
typedef struct libdem_dem libdem_dem;

/* A fill method with its settings. */
typedef struct libdem_method libdem_method;

/* One setting of a method. */
typedef struct libdem_setting {
  const char* name;
  const char* type;          /* "number", "integer", "boolean" or "choice" */
  const char* unit;          /* "" when it has none */
  const char* range;         /* "[0, 1]", "a | b", "" without limits */
  const char* default_value; /* as libdem_set takes it */
  const char* doc;
} libdem_setting;

/* How a call runs. Neither threads nor progress change a bit of a result. */
typedef struct libdem_run {
  int threads; /* 0: as many as there are cores */
  /* NULL, or a function that is called from time to time, from the calling thread, with the part
   * done (0 to 1) and the name of the current step. It returns 0 to stop the work. */
  int (*progress)(double part, const char* what, void* user);
  void* user;
} libdem_run;

/* "0.1.0" */
const char* libdem_version(void);

/* ---- DEMs */

/* Copies cols x rows heights in metres, row by row, row 0 in the north. `known`: one byte a cell, 0
 * where the height is to be reconstructed; NULL: heights that are NaN or infinite are unknown.
 * dx_m, dy_m: width and height of a cell in metres. */
libdem_status libdem_create(const float* heights, const uint8_t* known, int cols, int rows,
                            double dx_m, double dy_m, libdem_dem** dem, libdem_error* error);

/* Reads a file of one band: anything GDAL opens, .hgt of any square size, heightmap images. */
libdem_status libdem_read(const char* path, libdem_dem** dem, libdem_error* error);

/* Writes a file. The extension decides the format. Cell type, nodata value and coordinate system
 * are those of the file that the DEM comes from. The path never holds a part of a file, because the
 * file is renamed when it is complete. An existing file is an error unless `overwrite` is not 0. */
libdem_status libdem_write(const libdem_dem* dem, const char* path, int overwrite,
                           libdem_error* error);

/* The same for sigma, in metres. LIBDEM_INVALID when the DEM has none. */
libdem_status libdem_write_sigma(const libdem_dem* dem, const char* path, int overwrite,
                                 libdem_error* error);

/* Frees a DEM; NULL is allowed. */
void libdem_free(libdem_dem* dem);

int libdem_cols(const libdem_dem* dem);
int libdem_rows(const libdem_dem* dem);
double libdem_dx_m(const libdem_dem* dem); /* in the middle row, when cells are in degrees */
double libdem_dy_m(const libdem_dem* dem);

/* cols x rows values that live as long as the DEM. A height has no meaning where known is 0.
 * Sigma is the standard error in metres, 0 at known cells. It is NULL unless the DEM was filled by
 * a method whose settings asked for it (spline: sigma = law). */
const float* libdem_heights(const libdem_dem* dem);
const uint8_t* libdem_known(const libdem_dem* dem);
const float* libdem_sigma(const libdem_dem* dem);

/* ---- Methods */

/* The methods, in the order of `dem methods`; NULL beyond the last. */
size_t libdem_method_count(void);
const char* libdem_method_name(size_t number);
const char* libdem_method_summary(size_t number);

/* A method by its name, "mcmd" or with a preset "mcmd:paper"; NULL: the default. */
libdem_status libdem_choose(const char* name, libdem_method** method, libdem_error* error);

/* The settings of a method; LIBDEM_INVALID beyond the last. */
size_t libdem_setting_count(const libdem_method* method);
libdem_status libdem_setting_at(const libdem_method* method, size_t number, libdem_setting* setting,
                                libdem_error* error);

/* Changes a setting: libdem_set(method, "sigma", "law", &error). A value that is not allowed
 * changes nothing. */
libdem_status libdem_set(libdem_method* method, const char* name, const char* value,
                         libdem_error* error);

/* Frees a method; NULL is allowed. */
void libdem_free_method(libdem_method* method);

/* Which voids are filled, and how. A struct of zeros chooses all of them. */
typedef struct libdem_choice {
  int whole;             /* not 0: one window for the whole raster, as with `dem fill --whole` */
  int inner_only;        /* not 0: voids that touch the border are left */
  double max_area_km2;   /* larger voids are left; 0: no limit */
  double max_distance_m; /* voids with a cell farther from known cells are left; 0: no limit */
  size_t min_cells;      /* smaller voids are left */
  const char* where;     /* a condition, "area_km2 < 5 and not at_border"; NULL: none */
} libdem_choice;

/* Fills the voids into a DEM of its own; known cells come back bit for bit. The heights are those
 * that `dem fill` writes. Cells of voids that were left are unknown. method NULL: the default;
 * choice NULL: all voids; run NULL: all cores, no progress. */
libdem_status libdem_fill(const libdem_dem* dem, const libdem_method* method,
                          const libdem_choice* choice, const libdem_run* run, libdem_dem** filled,
                          libdem_error* error);

/* Errors of elevation, got - truth, in metres, over a set of cells. */
typedef struct libdem_errors {
  size_t cells;
  double rmse_m, mae_m, bias_m; /* root of the mean square, mean of the sizes, mean */
  double nmad_m, le90_m, max_m; /* 1.4826 median |e - median e|; 90 % are not larger; largest */
  double slope_rmse_deg;        /* of the slope; NaN when no cell has eight neighbours */
} libdem_errors;

/* Compares a reconstruction with the truth, over the cells known in both. `sampled`: the DEM that
 * was filled; then the cells that it does not know are judged alone. NULL: not given. All have one
 * size. */
libdem_status libdem_evaluate(const libdem_dem* truth, const libdem_dem* got,
                              const libdem_dem* sampled, libdem_errors* errors,
                              libdem_error* error);

#ifdef __cplusplus
}
#endif

#endif
