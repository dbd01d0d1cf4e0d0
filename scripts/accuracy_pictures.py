#!/usr/bin/env python3
"""Makes the pictures of ACCURACY.md: what is known, the truth, libdem, GMT surface, and both errors.

    scripts/accuracy_pictures.py      needs DEM_TESTDATA, gmt, python3-numpy and python3-gdal

Each row of CASES is a terrain, a way of `dem sample`, and the window that is shown.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
    from osgeo import gdal
except ImportError as error:
    sys.exit(f"accuracy_pictures.py: {error}; apt-get install python3-numpy python3-gdal, and run by /usr/bin/python3")
gdal.UseExceptions()

ROOT = pathlib.Path(__file__).resolve().parents[1]
DEM = str(pathlib.Path(os.environ.get("DEM", ROOT / "build/release/apps/dem/dem")).resolve())
SIDE = 256  # cells shown to a side
# name, tile, how it was sampled, first column and row shown, metres at the ends of the colours
CASES = [
    ("voids", "mtwashington_1025_3s.tif", "--voids 10%", 480, 560, 60),
    ("edges", "lost_river_mackay_30m.tif", "--edges 10%", 400, 150, 120),
    ("random", "bigtujunga_30m.tif", "--keep 3.4%", 600, 200, 40),
]


def run(command, folder):
    done = subprocess.run(command.split(), cwd=folder, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"accuracy_pictures.py: {command}: {done.stderr.strip()}")


def read(path):
    return gdal.Open(str(path)).ReadAsArray()


def gmt_surface(folder):
    """Fills known.tif as users of GMT do."""
    z = read(folder / "known.tif").astype("f8")
    rows, cols = z.shape
    dataset = gdal.Open(str(folder / "known.tif"))  # it must outlive its band
    nodata = dataset.GetRasterBand(1).GetNoDataValue()
    y, x = numpy.nonzero(z != nodata)
    numpy.column_stack([x, rows - 1 - y, z[y, x]]).astype("f8").tofile(folder / "points.bin")
    run(f"gmt surface points.bin -bi3d -R0/{cols - 1}/0/{rows - 1} -I1 -T0 -Ggmt.nc", folder)
    run("gdal_translate -q gmt.nc gmt.tif", folder)
    filled = numpy.where(z != nodata, z, read(folder / "gmt.tif"))
    out = gdal.GetDriverByName("GTiff").CreateCopy(str(folder / "rival.tif"), gdal.Open(str(folder / "filled.tif")))
    out.WriteArray(filled.astype("f4"))
    out = None


def hillshade(folder, name):
    run(f"{DEM} render {name}.tif {name}.png --overwrite --quiet --style hillshade", folder)
    return gdal.Open(str(folder / f"{name}.png")).ReadAsArray()


def colours(error, metres):
    """Blue: too low, red: too high."""
    part = numpy.clip(error / metres, -1, 1)
    fade = 1 - numpy.abs(part)
    rgb = numpy.stack([numpy.where(part > 0, 1, fade), fade, numpy.where(part < 0, 1, fade)])
    return (255 * rgb).astype("u1")


def grey(picture):
    if picture.ndim == 2:
        picture = picture[None]
    return numpy.repeat(picture[:1], 3, axis=0).astype("u1")


def panel(picture, col, row):
    window = picture[:, row:row + SIDE, col:col + SIDE]
    return numpy.pad(window, ((0, 0), (2, 2), (2, 2)), constant_values=255)


def main():
    data = pathlib.Path(os.environ.get("DEM_TESTDATA", ROOT / "../shared/data")).resolve()
    for name, tile, how, col, row, metres in CASES:
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            run(f"{DEM} sample {data / tile} known.tif --quiet {how}", folder)
            run(f"{DEM} fill known.tif filled.tif --quiet --type float32", folder)
            gmt_surface(folder)
            os.symlink(data / tile, folder / "truth.tif")
            truth = read(folder / "truth.tif").astype("f8")
            known = read(folder / "known.tif").astype("f8") == truth
            errors = [read(folder / f"{n}.tif") - truth for n in ("filled", "rival")]
            removed = numpy.array([[[40]], [[40]], [[90]]])
            shown = numpy.where(known, grey(hillshade(folder, "truth")), removed).astype("u1")
            pictures = [shown] + [grey(hillshade(folder, n)) for n in ("truth", "filled", "rival")]
            pictures += [colours(e, metres) for e in errors]
            strip = numpy.concatenate([panel(p, col, row) for p in pictures], axis=2)
            memory = gdal.GetDriverByName("MEM").Create("", strip.shape[2], strip.shape[1], 3)
            memory.WriteArray(numpy.ascontiguousarray(strip))
            gdal.GetDriverByName("JPEG").CreateCopy(str(ROOT / f"accuracy/{name}.jpg"), memory, options=["QUALITY=70"])
            rmse = [float(numpy.sqrt(numpy.mean(e[~known] ** 2))) for e in errors]
            print(f"{name}: RMSE {rmse[0]:.2f} m, GMT surface {rmse[1]:.2f} m")


main()
