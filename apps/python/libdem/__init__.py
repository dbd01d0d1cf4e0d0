"""Reconstruction of digital elevation models: fill, grid, supersample, evaluate, generate, erode.

    import libdem
    dem = libdem.read("N36E008.hgt")            # or any 2-D array with NaN, a mask, or nodata=
    filled = libdem.fill(dem, sigma=True)
    filled.elevation, filled.sigma, filled.source, filled.report
    libdem.write("filled.tif", filled)

Arrays are rows from north to south, columns from west to east, heights in metres. Every function
takes `threads` (0: all cores; the result is the same) and `progress` (True for a bar, or a function
of the part done and what is being done); Ctrl-C stops any of them. `libdem.methods()` lists the
methods and their settings, which are keywords of `fill`, `grid` and `supersample`.

`import libdem.xarray` adds `DataArray.dem.fill()`; `libdem.distributed` fills mosaics on a Dask
cluster. Wrong arguments raise ValueError, files OSError, a stop KeyboardInterrupt.
"""

from ._api import (CellOrigin, Dem, Eroded, Filled, Scores, erode, evaluate, fill, generate, grid,
                   read, render, sample, supersample, write)
from ._progress import ProgressBar
from ._tables import Field, Method, Preset, erosion_fields, generators, methods, style_fields
from ._core import version as __version__

__all__ = ["CellOrigin", "Dem", "Eroded", "Field", "Filled", "Method", "Preset", "ProgressBar", "Scores",
           "erode", "erosion_fields", "evaluate", "fill", "generate", "generators", "grid", "methods",
           "read", "render", "sample", "style_fields", "supersample", "write"]
