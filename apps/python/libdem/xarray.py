"""`import libdem.xarray` adds `.dem` to DataArrays: fill and supersample that keep what xarray knows.

    import rioxarray, libdem.xarray
    dem = rioxarray.open_rasterio("sparse.tif").squeeze("band")
    filled = dem.dem.fill()                          # coordinates, CRS, attributes stay
    layers = dem.dem.fill(sigma=True, full=True)     # a Dataset: elevation, sigma, source
"""

import numpy as np
import xarray as xr

from . import _api


def _plane(array):
    """The array as rows and columns: (y, x), or one band of (band, y, x)."""
    try:
        import rioxarray  # noqa: F401  (gives .rio)
    except ImportError:
        raise ImportError("libdem.xarray needs rioxarray (Debian: python3-rioxarray)") from None
    y, x = array.rio.y_dim, array.rio.x_dim
    others = [d for d in array.dims if d not in (y, x)]
    for d in others:
        if array.sizes[d] != 1:
            raise ValueError(f"the array has {array.sizes[d]} values along {d}; must be one, choose it by .isel({d}=0)")
    return array.squeeze(others, drop=True).transpose(y, x)


def _north_up(plane):
    """Whether rows run from north to south, and to_world (of centres) of the array with such rows.

    The coordinates say where cells are; how large they are is said without rounding by the transform
    that came with the file, and taken from it where the two agree.
    """
    now, stored = plane.rio.transform(recalc=True), plane.rio.transform()
    if now.b or now.d:
        raise ValueError("the array's rows do not run along x; reproject it first")
    sizes = [(now.a, stored.a), (-abs(now.e), -abs(stored.e))]
    dx, dy = (b if abs(a - b) <= 1e-6 * abs(a) else a for a, b in sizes)
    x, y = plane[plane.rio.x_dim].values, plane[plane.rio.y_dim].values
    return bool(now.e < 0), (float(x[0]), dx, 0.0, float(y.max()), 0.0, dy)


def as_dem(array, known=None):
    """A Dem from a DataArray; where rows run from south to north they are turned."""
    plane = _plane(array)
    down, to_world = _north_up(plane)
    values = plane.values if down else plane.values[::-1]
    if known is not None:
        known = np.asarray(known) if down else np.asarray(known)[::-1]
    crs = plane.rio.crs
    return _api._as_dem(values, known, None, plane.rio.nodata, to_world, crs.to_wkt() if crs else "")[0]


def _like(array, values):
    """An array as the given one, its values from rows that run from north to south."""
    values = values if _north_up(_plane(array))[0] else values[::-1]
    if array.dims.index(array.rio.x_dim) < array.dims.index(array.rio.y_dim):
        values = values.T
    return array.copy(data=values.reshape(array.shape))


@xr.register_dataarray_accessor("dem")
class DemAccessor:
    """Fills DataArrays of elevations; rows and columns are those of rioxarray."""

    def __init__(self, array):
        self._array = array

    def fill(self, known=None, *, full=False, **options):
        """As `libdem.fill`, with its keywords; coordinates, CRS, encoding and attributes stay.

        Unknown: NaN, and the no-data value that rioxarray knows of.
        Returns a DataArray of elevations in float32 (float64 if the array is); full=True: a Dataset
        with elevation, source and, when asked for, sigma.
        """
        dem = as_dem(self._array, known)
        filled = _api.fill(dem, **options)
        elevation = _like(self._array, filled.elevation)
        if not full:
            return elevation
        layers = {"elevation": elevation, "source": _like(self._array, filled.source)}
        layers["source"].attrs = {f"class_{o.value}": o.name for o in _api.CellOrigin}
        if filled.sigma is not None:
            layers["sigma"] = _like(self._array, filled.sigma)
            layers["sigma"].attrs = {"long_name": "standard deviation of the elevation", "units": "m"}
        return xr.Dataset(layers)

    def supersample(self, factor, **options):
        """As `libdem.supersample`: a DataArray on the finer lattice, in the same CRS."""
        plane = _plane(self._array)
        fine = _api.supersample(as_dem(self._array), factor, **options)
        x0, dx, _, y0, _, dy = fine.dem.to_world
        rows, cols = fine.dem.shape
        coords = {plane.rio.y_dim: y0 + dy * np.arange(rows), plane.rio.x_dim: x0 + dx * np.arange(cols)}
        out = xr.DataArray(fine.elevation, coords, (plane.rio.y_dim, plane.rio.x_dim), plane.name, plane.attrs)
        crs = plane.rio.crs
        return out.rio.write_crs(crs) if crs else out
