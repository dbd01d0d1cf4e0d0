"""What the package offers, on arrays."""

import dataclasses
import enum
import json
import operator
import os
import types
import warnings

import numpy as np

from . import _core, _tables
from ._core import Dem
from ._progress import callback

CellOrigin = enum.IntEnum("CellOrigin", _core.cell_origins)
CellOrigin.__doc__ = "Where the height of a cell comes from: the values of `Filled.source`."


@dataclasses.dataclass(frozen=True, repr=False)
class Filled:
    """A reconstruction. `dem` is the whole of it, which `libdem.write` takes."""
    dem: Dem
    sigma: object   #: standard deviation in metres, 0 at known cells; None when not asked for
    source: object  #: where each cell comes from, see `CellOrigin`; None but for `fill`
    report: dict    #: what was done, and what the method says of itself

    @property
    def elevation(self):
        """Heights without holes; float64 where float32 cannot hold the known ones, else float32."""
        return self.dem.elevation

    def __array__(self, dtype=None):
        return np.asarray(self.elevation, dtype=dtype)

    def __repr__(self):
        return f"<libdem.Filled {self.dem!r}{'' if self.sigma is None else ', with sigma'}>"


@dataclasses.dataclass(frozen=True, repr=False)
class Eroded:
    """A worn terrain."""
    dem: Dem
    water_m: object  #: depth of the water that stands at the end
    report: dict     #: volumes in cubic metres: before_m3 = after_m3 + carried_m3

    @property
    def elevation(self):
        return self.dem.z

    def __repr__(self):
        return f"<libdem.Eroded {self.dem!r}>"


class Scores(types.SimpleNamespace):
    """Errors of a reconstruction: `all.rmse_m`, `filled.le90_m` (None without `sampled`) ...,
    `calibration.within_1_sigma` ... (None without `sigma`), `unfilled_cells`, and `spectrum`: arrays
    wavelength_m, truth_m4, got_m4, waves."""


def _array(z):
    """An array of native byte order, and what a numpy mask says is known."""
    known = None
    if np.ma.isMaskedArray(z):
        known = ~np.ma.getmaskarray(z)
        z = z.data
    z = np.asarray(z)
    if z.dtype.kind in "iu" and z.dtype.itemsize == 8:
        z = z.astype(np.float64)
    elif z.dtype == np.float16:
        z = z.astype(np.float32)
    elif not z.dtype.isnative:
        z = z.astype(z.dtype.newbyteorder("="))
    return z, known


def _is_dataarray(z):
    return type(z).__module__.split(".")[0] == "xarray" and hasattr(z, "dims")


def _as_dem(z, known=None, spacing=None, nodata=None, to_world=None, crs="", warn=True):
    """A Dem, and whether it was made here (nobody else has it)."""
    if isinstance(z, (Filled, Eroded)):
        z = z.dem
    given = {"known": known, "spacing": spacing, "nodata": nodata, "to_world": to_world, "crs": crs or None}
    if isinstance(z, Dem):
        extra = [name for name, value in given.items() if value is not None]
        if extra:
            raise ValueError(f"{extra[0]} is for arrays; a Dem has its own")
        return z, False
    if _is_dataarray(z):
        from . import xarray as of_xarray
        return of_xarray.as_dem(z, known), True
    if known is not None:
        known = np.asarray(known)
        if known.dtype.kind in "iu" and known.dtype != np.uint8:
            known = known != 0
    array, mask = _array(z)
    if mask is not None:
        if known is not None and known.shape != array.shape:
            raise ValueError(f"known has shape {known.shape}; must be {array.shape}, as z")
        known = mask if known is None else mask & (known != 0)
    if spacing is not None:
        spacing = _pair("spacing", spacing)
    if to_world is not None:
        to_world = _numbers("to_world", to_world, 6, "six numbers: x0, dx, 0, y0, 0, -dy")
    dem = _call.Dem(array, known, nodata, spacing, to_world, crs)
    if warn and (text := dem._outlier_warning):
        warnings.warn(text, stacklevel=3)
    return dem, True


def _numbers(name, value, count, must_be):
    """So many numbers as floats; one number stands for all of two."""
    try:
        numbers = [float(v) for v in ([value] * count if count == 2 and np.isscalar(value) else value)]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != count:
        raise ValueError(f"{name} = {value!r}; must be {must_be}")
    return tuple(numbers)


def _pair(name, value):
    return _numbers(name, value, 2, "one length or two, east and north, in metres")


def _whole(name, value, least):
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if not least <= number < 2**31:
        raise ValueError(f"{name} = {value!r}; must be a whole number from {least} up")
    return number


def _threads(threads):
    return _whole("threads", threads, 0)


class _Core:
    """The module's functions; arguments of a wrong type are told of in one line."""

    def __getattr__(self, name):
        function = getattr(_core, name)

        def call(*arguments):
            try:
                return function(*arguments)
            except TypeError as error:
                if "incompatible" not in str(error):
                    raise
                expected = str(error).split("\n")[1].strip().removeprefix("1. ")
                raise TypeError(f"{name}: an argument has a wrong type; expected {expected}") from None
        return call


_call = _Core()


def _method_settings(method, settings):
    if isinstance(settings.get("sigma"), (bool, np.bool_)):
        settings = {**settings, "sigma": "law" if settings["sigma"] else "none"}
    return _tables.as_settings(settings)


def fill(z, known=None, *, method=_core.default_method, spacing=None, nodata=None, to_world=None, crs="",
         inner_only=False, max_area_km2=None, max_distance_m=None, min_cells=None, where="", region="",
         whole=False, aux=(), water="", report_holes=False, threads=0, progress=None, **settings):
    """Fills the holes of a DEM; known cells come back bit for bit.

    The same numbers as `dem fill`, bit for bit, for any number of threads.

    z         heights in metres: a 2-D array (float32, float64, integers), a masked array, an xarray
              DataArray or a Dem of `read`. Unknown: NaN, masked cells, cells equal to `nodata`.
    known     an array of the same shape, 0 or False where a cell is to be filled
    method    one of `methods()`, NAME or NAME:PRESET; its settings are further keywords
    spacing   (dx, dy) of a cell in metres, for arrays; or
    to_world, crs   (x0, dx, 0, y0, 0, -dy): the centre of the first cell and the steps in CRS units;
              cells in degrees then have their true size, row by row

    Which holes (all by default): inner_only (none that touches the border), max_area_km2,
    max_distance_m (to data), min_cells, where ("area_km2 < 5 and not at_border"), region (a file of
    polygons). whole: one problem, not hole by hole; so by itself above 25 % unknown.
    aux: files of DEMs to fill over; water: a file of polygons that lie flat.
    report_holes: report["holes"] lists each hole, with errors of hidden rim cells.

    Returns a Filled. sigma=True also gives a standard deviation (method spline).
    Copies: z once (a Dem too: it is not changed); what comes back is not copied.
    """
    dem, temporary = _as_dem(z, known, spacing, nodata, to_world, crs)
    choice = _call.HoleChoice(inner_only, max_area_km2, max_distance_m, min_cells, where)
    files = [os.fspath(file) for file in ([aux] if isinstance(aux, (str, os.PathLike)) else aux)]
    with callback(progress) as call:
        filled, sigma, source, report = _call.fill(
            dem, temporary, method, _method_settings(method, settings), choice, whole, files,
            os.fspath(water), os.fspath(region), report_holes, _threads(threads), call)
    return Filled(filled, sigma, source, json.loads(report))


def supersample(z, factor, *, known=None, preserve="heights", nodes=None, method=_core.default_method,
                spacing=None, nodata=None, to_world=None, crs="", threads=0, progress=None, **settings):
    """A DEM on a finer lattice; its unknown cells are filled too.

    factor    so many fine cells to a coarse one, along either axis; above 1
    preserve  "heights": met at the coarse cells' centres; "block-mean": the mean over each is kept
    nodes     the outer fine cells have the centres of the outer coarse ones (by default as the file
              says; arrays: no), else both have the same outer edges
    method, settings, and what z may be: as `fill`

    Returns a Filled: its dem has the finer lattice, its report miss_rms_m and miss_max_m.
    """
    dem, _ = _as_dem(z, known, spacing, nodata, to_world, crs)
    how = {"factor": factor, "preserve": preserve, **({} if nodes is None else {"nodes": bool(nodes)})}
    with callback(progress) as call:
        return Filled(*_with_no_source(_call.supersample(
            dem, _tables.as_settings(how), method, _method_settings(method, settings), _threads(threads), call)))


def grid(x=None, y=None, z=None, *, contours=None, breaklines=None, like=None, bounds=None, cell="", crs="",
         to_crs="", nodes=False, point_sigma=None, point_weight=None, x_field="", y_field="", z_field="",
         sigma_field="", weight_field="", position_field="", delimiter=None, layer="", classes=(), nodata=None,
         combine="mean", reject_outliers=0.0, snap=False, passes=1, no_fill=False, method="", threads=0,
         progress=None, **settings):
    """A DEM from scattered points or contour lines. The same numbers as `dem grid`, bit for bit.

    One of:
    x, y, z   arrays of one length; points that are not finite are left out
    x         the path of a file of points: text with columns, LAS, or a vector layer
    contours  contour lines: the path of a vector layer, or a list of (level, xy) with xy an array of
              shape (n, 2); no terraces appear between them

    breaklines   lines across which the surface may jump: the path of a vector layer, or a list of arrays
              of shape (n, 2), in the coordinate system `crs`
    like      a Dem whose lattice is used; otherwise
    bounds    (west, south, east, north), the outer edges of the cells (nodes=True: the centres of the
              outer ones); without them, what the points cover
    cell      cell size with its unit, "30m", "1s", "0.001deg"; without it, from the density of the points
    crs       coordinate system of x and y, "EPSG:32632", WKT; "": that of the file, or metres
    to_crs    coordinate system of the DEM; "": that of the points
    point_sigma, point_weight   standard error in metres and weight of each point, arrays
    x_field, y_field, z_field, sigma_field, weight_field, position_field   columns of a file, by name or
              by number from 1; z_field is also the attribute of a vector layer
    delimiter, layer, classes, nodata   how a file is read: character between columns, layer of a vector
              file, LAS classes, elevation that means nodata
    combine   how the points of one cell become one height: mean, min, max, median
    reject_outliers   drop cells more than this many robust standard deviations from their neighbours
    snap      move each point to the centre of its cell
    passes    number of correction passes that pull the surface to points off cell centres
    no_fill   cells without points stay unknown
    method    as `fill`; "": the default one, or `contours` for contour lines; its settings are further
              keywords

    Returns a Filled.
    """
    source = _grid_input(x, y, z, contours, breaklines, point_sigma, point_weight)
    if like is not None:
        like, _ = _as_dem(like)
    if bounds is not None:
        bounds = _numbers("bounds", bounds, 4, "west, south, east, north")
    read = {"x_field": x_field, "y_field": y_field, "z_field": z_field, "sigma_field": sigma_field,
            "weight_field": weight_field, "position_field": position_field, "layer": layer, "crs": crs,
            "to_crs": to_crs, **({} if nodata is None else {"nodata": nodata})}
    binning = _tables.as_settings({"combine": combine, "plane": not snap, "outliers": reject_outliers})
    gridding = _tables.as_settings({"passes": passes})
    cell = f"{cell}m" if isinstance(cell, (int, float)) else cell
    with callback(progress) as call:
        dem, sigma, report = _call.grid(
            source, _tables.as_settings(read), list(classes), delimiter, like, bounds, cell, nodes, binning,
            gridding, method, _method_settings(method, settings), not no_fill, _threads(threads), call)
    return Filled(dem, sigma, None, json.loads(report))


def _is_path(value):
    return isinstance(value, (str, os.PathLike))


def _grid_input(x, y, z, contours, breaklines, point_sigma, point_weight):
    """What `grid` makes a DEM from."""
    source = _core.GridInput()
    given = [v is not None for v in (x, y, z, point_sigma, point_weight)]
    if contours is not None:
        if any(given):
            raise ValueError("contours: points cannot be gridded together with contour lines")
        if _is_path(contours):
            source.read_file(os.fspath(contours), True)
        else:
            source.take_contours(_lines("contours", contours, "(level, xy)", lambda line: (
                float(line[0]), np.asarray(line[1], dtype=np.float64))))
    elif _is_path(x):
        if any(given[1:]):
            raise ValueError("x is a file, which has y, z and their errors; leave out the arrays")
        source.read_file(os.fspath(x), False)
    elif not all(given[:3]):
        raise ValueError("x, y and z, the path of a file, or contours are needed")
    else:
        source.take_points(x, y, z, point_sigma, point_weight)
    if breaklines is not None:
        if _is_path(breaklines):
            source.read_breaklines(os.fspath(breaklines))
        else:
            source.take_breaklines(_lines("breaklines", breaklines, "xy", lambda line: np.asarray(
                line, dtype=np.float64)))
    return source


def _lines(name, lines, form, convert):
    try:
        return [convert(line) for line in lines]
    except (TypeError, ValueError, IndexError):
        raise ValueError(f"{name}: must be a path, or a list of {form} with xy of shape (n, 2)") from None


def _with_no_source(result):
    dem, sigma, report = result
    return dem, sigma, None, report


def sample(z, *, keep=None, count=None, every=None, edges=None, voids=None, tracks=None, contours_m=None,
           greedy=None, max_error_m=None, seed=1, method=_core.default_method, known=None, spacing=None,
           nodata=None, to_world=None, crs="", threads=0, progress=None):
    """Makes a problem from a whole DEM: a Dem with fewer known cells. Exactly one of:

    keep        this share of the known cells, at random: 0.034
    count       this many cells, at random
    every       every n-th column and row
    edges       this share, where Sobel's gradient is strongest
    voids       cut ragged voids until this share is gone
    tracks      so many straight tracks, as a ship's
    contours_m  contour lines so far apart
    greedy      this many cells, those that `method` would miss worst
    max_error_m so many that `method` misses no cell by more

    A seed gives the same cells on every machine.
    """
    ways = {"keep": keep, "count": count, "every": every, "edges": edges, "voids": voids, "tracks": tracks,
            "contours_m": contours_m, "greedy": greedy, "max_error_m": max_error_m}
    given = [(way, value) for way, value in ways.items() if value is not None]
    if len(given) != 1:
        raise ValueError(f"exactly one of {', '.join(ways)} is needed; {len(given)} were given")
    dem, _ = _as_dem(z, known, spacing, nodata, to_world, crs)
    with callback(progress) as call:
        return _call.sample(dem, *given[0], seed, method, _threads(threads), call)


def evaluate(truth, got, sampled=None, *, sigma=None, spacing=None, nodata=None, to_world=None, crs="",
             threads=0, progress=None):
    """Compares a reconstruction with the truth: Scores.

    sampled   what `got` was made from: the cells that it does not know are judged, too
    sigma     an array of the predicted standard errors in metres: Scores.calibration says how well they
              predicted the errors
    The first three are arrays or Dems. For arrays, spacing and place are those of all.
    """
    def as_dem(z):
        own = isinstance(z, (Dem, Filled, Eroded)) or _is_dataarray(z)
        return _as_dem(z, **({} if own else dict(spacing=spacing, nodata=nodata, to_world=to_world, crs=crs)),
                       warn=False)[0]
    with callback(progress) as call:
        text = _call.evaluate(as_dem(truth), as_dem(got), None if sampled is None else as_dem(sampled),
                              None if sigma is None else np.asarray(sigma, np.float32), _threads(threads), call)
    scores = json.loads(text)
    errors = {key: value and types.SimpleNamespace(**value) for key, value in scores.items()
              if key in ("all", "filled", "calibration")}
    bins = scores["spectrum"]
    names = ["wavelength_m", "truth_m4", "got_m4", "waves"]
    spectrum = types.SimpleNamespace(**{n: np.array([b[n] for b in bins]) for n in names}) if bins else None
    return Scores(**errors, unfilled_cells=scores["unfilled_cells"], spectrum=spectrum)


def generate(name, shape=None, *, spacing=30.0, origin=(0.0, 0.0), crs="", image=None, median=0, threads=0,
             progress=None, **settings):
    """Terrain from nothing, or from a drawing: a Dem whose cells are all known.

    name      one of `generators()`, NAME or NAME:PRESET; its settings are further keywords
    shape     (rows, columns); by default 1025 x 1025, 720 x 1440 for the whole Earth, or the image's
    spacing   size of a cell in metres, one number or (dx, dy)
    origin, crs   x and y of the north-west cell's centre in a coordinate system ("EPSG:32619")
    image     what some generators start from: an array of grey levels from 0 to 1, or a file
    median    passes of a 5 x 5 median over the result
    """
    array, file = None, ""
    if isinstance(image, (str, os.PathLike)):
        file = os.fspath(image)
    elif image is not None:
        array, _ = _array(image)
    if shape is not None:
        rows, cols = _numbers("shape", shape, 2, "rows and columns")
        shape = _whole("rows", int(rows), 1), _whole("columns", int(cols), 1)
    with callback(progress) as call:
        return _call.generate(name, _tables.as_settings(settings), shape, _pair("spacing", spacing),
                              _numbers("origin", origin, 2, "x and y"), crs, array, file, median,
                              _threads(threads), call)


def erode(z, *, known=None, spacing=None, nodata=None, to_world=None, crs="", threads=0, progress=None,
          **settings):
    """Erodes a DEM by running water and falling rock. Unknown cells are outside, behind a wall.

    What z may be: as `fill`. Returns an Eroded.
    """
    dem, _ = _as_dem(z, known, spacing, nodata, to_world, crs)
    with callback(progress) as call:
        return Eroded(*_call.erode(dem, _tables.as_settings(settings), _threads(threads), call))


def render(z, style="relief", *, known=None, spacing=None, nodata=None, to_world=None, crs="", camera=None,
           target=None, threads=0, progress=None, **settings):
    """A picture of a DEM as an array of bytes: (rows, columns, 3), or (rows, columns) for a hillshade.

    style     "relief" and "hillshade": maps, a pixel a cell; "view": a perspective view
    camera, target   of a view: (x, y, z) in the DEM's coordinates; z as "+200" is 200 m above ground
    What z may be: as `fill`.
    """
    dem, _ = _as_dem(z, known, spacing, nodata, to_world, crs)

    def place(point):
        return "" if point is None else ",".join(str(part) for part in point)
    with callback(progress) as call:
        return _call.render(dem, style, _tables.as_settings(settings), place(camera), place(target),
                            _threads(threads), call)


def read(path, *, band=0, nodata=None, detect_nodata=True, tile="", height_range=None, threads=0,
         progress=None):
    """Reads elevations from a file: .hgt (also zipped), images, and what GDAL opens. A Dem.

    band      1, 2, ...; needed when there are several
    nodata    this value means unknown, whatever the file declares
    detect_nodata   look for undeclared -32768, -9999, 32767
    tile      "N36E008" for an .hgt whose name does not say
    height_range    (low, high) in metres of black and white of a heightmap image
    """
    with callback(progress) as call:
        return _call.read(os.fspath(path), band, nodata, detect_nodata, tile, height_range, _threads(threads), call)


def write(path, z, *, known=None, spacing=None, to_world=None, crs="", format="", dtype=None, nodata=None,
          compress=True, overwrite=False, metadata=None, threads=0, progress=None):
    """Writes a Dem, a Filled or an array; the format follows the extension, the type the origin's.

    The path holds what it held before, or the whole new file; an existing file is refused without
    overwrite=True. Unknown cells get the no-data value, which is always declared.
    dtype     "int16", "float32" ...; integers are rounded
    nodata    the value that the file declares as unknown
    """
    dem, _ = _as_dem(z, known, spacing, None, to_world, crs, warn=False)
    if not overwrite and os.path.exists(path):
        raise FileExistsError(f"{os.fspath(path)}: exists; overwrite=True replaces it")
    with callback(progress) as call:
        _call.write(os.fspath(path), dem, format, None if dtype is None else str(np.dtype(dtype)), nodata,
                    compress, overwrite, list((metadata or {}).items()), _threads(threads), call)


fill.__doc__ += "\n    " + _tables.settings_doc(
    f"Methods and their settings (default method: {_core.default_method}):",
    _tables.methods().values()).replace("\n", "\n    ")
fill.__doc__ += "\n\n    Names for `where`: " + ", ".join(name for name, _ in _core.hole_facts()) + "\n    "
generate.__doc__ += "\n    " + _tables.settings_doc(
    "Generators and their settings:", _tables.generators().values()).replace("\n", "\n    ")
erode.__doc__ += "\n    " + _tables.settings_doc("Settings:", _tables.erosion_fields()).replace("\n", "\n    ")
for _style, _fields in _tables.style_fields().items():
    render.__doc__ += "\n    " + _tables.settings_doc(
        f"Settings of {_style}:", _fields).replace("\n", "\n    ") + "\n"
