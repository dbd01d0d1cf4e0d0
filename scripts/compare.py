#!/usr/bin/env python3
"""Fills one DEM with libdem's methods and with whatever of GDAL, GMT, GRASS and SAGA is installed.

    scripts/compare.py TRUTH FOLDER [--sample='--keep 3.4%'] [--only REGEX] [--repeat 3]

Cells are removed from TRUTH, which should be whole, by `dem sample`; each program fills them; RMSE,
mean and largest error are taken over the removed cells. Writes FOLDER/compare.csv, compare.svg and
compare.json; the last one `dem curve --rivals` draws into its picture.

CPU seconds are user plus system time of the program that fills, its start and the files it reads
and writes itself included; conversions before and after are not counted. With --repeat it is the median.
The programs of others get square cells of size 1, as their users do; `gmt surface -A` knows the
cells' shape. Cells that a program leaves empty are counted, and filled with the nearest one.
Needs python3-numpy and python3-gdal, and `dem` (--dem, default build/release/apps/dem/dem).
"""
import argparse
import csv
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

try:
    import numpy
    from osgeo import gdal
except ImportError as error:
    sys.exit(f"compare.py: {error}; apt-get install python3-numpy python3-gdal, and run by /usr/bin/python3")
gdal.UseExceptions()

NODATA = -9999
ROOT = pathlib.Path(__file__).resolve().parents[1]

# name: (program that must be there, commands before, the command that is timed, commands after).
# Each runs in a folder of its own and leaves filled.tif. {in}: raster with holes, {points}: x y z as
# doubles, {vrt}: the same as text, {radius}: of the largest hole, {aspect}: cell width / height.
GRASS = "grass loc/PERMANENT --exec "
GMT = "gmt surface {points} -bi3d -R0/{last_col}/0/{last_row} -I1 -T0 -Gfilled.nc"
NC_TO_TIF = ["gdal_translate -q filled.nc filled.tif"]
GRASS_IN = ["grass -c XY loc -e", GRASS + "r.in.gdal -o input={in} output=dem", GRASS + "g.region raster=dem"]
GRASS_OUT = [GRASS + "r.out.gdal -c input=filled output=filled.tif format=GTiff type=Float32 nodata=-9999 -f"]
SAGA_OUT = ["gdal_translate -q -of GTiff filled.sdat filled.tif"]
OTHERS = {
    "gdal_fillnodata": ("gdal_fillnodata.py", [], "gdal_fillnodata.py -q -md {radius} -si 0 {in} filled.tif", []),
    "gdal_grid linear": ("gdal_grid", [],
        "gdal_grid -q -txe 0 {cols} -tye {rows} 0 -outsize {cols} {rows} -ot Float32 -of GTiff "
        "-a linear:radius=-1:nodata=-9999 -l points {vrt} filled.tif", []),
    "gmt surface -T0": ("gmt", [], GMT, NC_TO_TIF),
    "gmt surface -T0 -A": ("gmt", [], GMT + " -A{aspect}", NC_TO_TIF),
    "grass r.fillnulls rst": ("grass", GRASS_IN, GRASS + "r.fillnulls input=dem output=filled method=rst", GRASS_OUT),
    "grass r.fillnulls bicubic": ("grass", GRASS_IN,
        GRASS + "r.fillnulls input=dem output=filled method=bicubic memory=2000", GRASS_OUT),
    "saga close gaps": ("saga_cmd", [],
        "saga_cmd -f=s grid_tools 7 -INPUT {in} -RESULT filled.sgrd -THRESHOLD 0.1", SAGA_OUT),
    "saga close gaps, spline": ("saga_cmd", [],
        "saga_cmd -f=s grid_tools 25 -GRID {in} -CLOSED filled.sgrd -NEIGHBOURS 1 -MAXPOINTS 1000 -LOCALPOINTS 20",
        SAGA_OUT),
}


class Failed(Exception):
    """A program did not do what it was asked for."""


def run(command, folder, timeout):
    """Runs one command line; returns its CPU seconds and its wall seconds."""
    start = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(shlex.split(command), cwd=folder, stdin=subprocess.DEVNULL, start_new_session=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    try:
        said, _ = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        raise Failed(f"stopped after {timeout} s") from None
    if process.returncode != 0:
        raise Failed(f"exit code {process.returncode}: {' '.join(said.split())[-200:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, time.monotonic() - start


def read(path):
    """Heights as float64, NaN where the file holds none."""
    file = gdal.Open(str(path))
    band = file.GetRasterBand(1)
    z = band.ReadAsArray().astype(float)
    z[(z == band.GetNoDataValue()) | ~(numpy.abs(z) < 1e30)] = numpy.nan
    return z


def write(path, z):
    """Writes heights as square cells of size 1."""
    rows, cols = z.shape
    out = gdal.GetDriverByName("GTiff").Create(str(path), cols, rows, 1, gdal.GDT_Float32)
    out.SetGeoTransform((0, 1, 0, rows, 0, -1))
    band = out.GetRasterBand(1)
    band.SetNoDataValue(NODATA)
    band.WriteArray(numpy.where(numpy.isnan(z), NODATA, z))


def largest_hole_radius(known):
    """The largest distance of a removed cell from a known one, in cells."""
    rows, cols = known.shape
    rasters = [gdal.GetDriverByName("MEM").Create("", cols, rows, 1, gdal.GDT_Float32) for _ in range(2)]
    bands = [r.GetRasterBand(1) for r in rasters]
    bands[0].WriteArray(known.astype(float))
    gdal.ComputeProximity(bands[0], bands[1], ["VALUES=1"])
    return float(bands[1].ReadAsArray().max())


def describe_problem(z, folder, aspect):
    """Writes the files that the programs of others read; returns the names in their command lines."""
    rows, cols = z.shape
    row, col = numpy.nonzero(~numpy.isnan(z))
    points = numpy.column_stack([col, rows - 1 - row, z[row, col]])
    points.tofile(folder / "points.bin")
    numpy.savetxt(folder / "points.csv", points + [0.5, 0.5, 0], "%.10g", ",", header="x,y,z", comments="")
    (folder / "points.vrt").write_text(
        '<OGRVRTDataSource><OGRVRTLayer name="points"><SrcDataSource relativeToVRT="1">points.csv</SrcDataSource>'
        '<GeometryType>wkbPoint25D</GeometryType><GeometryField encoding="PointFromColumns" x="x" y="y" z="z"/>'
        '</OGRVRTLayer></OGRVRTDataSource>', encoding="utf-8")
    write(folder / "in.tif", z)
    return {"in": folder / "in.tif", "points": folder / "points.bin", "vrt": folder / "points.vrt", "cols": cols,
            "rows": rows, "last_col": cols - 1, "last_row": rows - 1, "aspect": f"{aspect:.6f}",
            "radius": math.ceil(largest_hole_radius(~numpy.isnan(z))) + 10}


def ask(dem, *words):
    """The JSON object that a verb of `dem` prints."""
    return json.loads(subprocess.run([dem, *words, "--json"], check=True, stdout=subprocess.PIPE).stdout)


def method_names(dem):
    """libdem's fill methods, with their presets."""
    for method in ask(dem, "methods")["fill"]:
        yield method["name"]
        for preset in method["presets"]:
            yield f"{method['name']}:{preset['name']}"


def contestants(dem, problem):
    """name -> (commands before, the one that is timed, commands after); who is missing is said."""
    fill = f"{dem} fill {problem['sampled']} filled.tif --quiet --threads 1 --method "
    found = {f"dem {name}": ([], fill + name, []) for name in method_names(dem)}
    for name, (program, *commands) in OTHERS.items():
        if shutil.which(program):
            found[name] = commands
        else:
            print(f"{name}: not compared, {program} is not installed")
    return found


def fill(commands, problem, folder, timeout):
    """Lets one contestant fill the problem; returns the heights, its CPU seconds and its wall seconds."""
    before, timed, after = commands
    for command in before:
        run(command.format(**problem), folder, timeout)
    cpu, wall = run(timed.format(**problem), folder, timeout)
    for command in after:
        run(command.format(**problem), folder, timeout)
    return read(folder / "filled.tif"), cpu, wall


def fill_the_rest(dem, z, folder):
    """Gives cells that were left empty the height of the nearest one."""
    write(folder / "rest.tif", z)
    run(f"{dem} fill rest.tif whole.tif --quiet --method nearest", folder, None)
    return read(folder / "whole.tif")


def measure(name, commands, problem, args):
    """One row of the table."""
    cpu, wall = [], []
    for _ in range(args.repeat):
        with tempfile.TemporaryDirectory(prefix="compare") as folder:
            folder = pathlib.Path(folder)
            try:
                filled, *seconds = fill(commands, problem, folder, args.timeout)
            except Failed as why:
                return {"method": name, "outcome": str(why)}
            empty = int(numpy.isnan(filled).sum())
            if empty:
                filled = fill_the_rest(args.dem, filled, folder)
        cpu.append(seconds[0])
        wall.append(seconds[1])
    removed = numpy.isnan(problem["heights"]) & ~numpy.isnan(problem["truth"])
    error = (filled - problem["truth"])[removed]
    return {"method": name, "outcome": "filled" if not empty else f"{empty} cells left empty",
            "rmse_m": float(numpy.sqrt(numpy.mean(error**2))), "mae_m": float(numpy.mean(numpy.abs(error))),
            "max_m": float(numpy.max(numpy.abs(error))), "cpu_s": statistics.median(cpu),
            "wall_s": statistics.median(wall)}


def pose_problem(args, folder):
    """Removes cells from the truth; what all contestants are asked."""
    sampled = folder / "sampled.tif"
    run(f"{args.dem} sample {shlex.quote(args.truth)} {sampled} --quiet --overwrite {args.sample}", ROOT, None)
    dx, dy = ask(args.dem, "info", str(sampled))["files"][0]["cell_m"]["middle"]
    heights = read(sampled)
    return {"truth": read(args.truth), "heights": heights, "sampled": sampled,
            **describe_problem(heights, folder, dx / dy)}


def ticks(low, high):
    """1, 2 and 5 times the powers of ten between two numbers."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [m * 10.0**p for p in powers for m in (1, 2, 5) if low <= m * 10.0**p <= high]


def picture(rows, title):
    """RMSE against CPU seconds, both logarithmic; libdem's methods are filled discs."""
    width, height, left, top, right, bottom = 900, 560, 70, 40, 210, 50
    xs, ys = [max(r["cpu_s"], 0.01) for r in rows], [r["rmse_m"] for r in rows]
    x_range, y_range = (min(xs) / 1.5, max(xs) * 1.5), (min(ys) / 1.1, max(ys) * 1.1)

    def place(value, limits, start, length):
        return start + length * math.log(value / limits[0]) / math.log(limits[1] / limits[0])

    def px(x):
        return place(x, x_range, left, width - left - right)

    def py(y):
        return place(y, y_range, height - bottom, -(height - top - bottom))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
           'font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="white"/>', f'<text x="{left}" y="24" font-size="15">{title}</text>']
    for x in ticks(*x_range):
        out.append(f'<path d="M{px(x):.1f} {top}V{height - bottom}" stroke="#ddd"/>'
                   f'<text x="{px(x):.1f}" y="{height - bottom + 16}" text-anchor="middle">{x:g}</text>')
    for y in ticks(*y_range):
        out.append(f'<path d="M{left} {py(y):.1f}H{width - right}" stroke="#ddd"/>'
                   f'<text x="{left - 6}" y="{py(y) + 4:.1f}" text-anchor="end">{y:g}</text>')
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 12}" text-anchor="middle">CPU seconds</text>')
    out.append(f'<text transform="translate(18 {height / 2}) rotate(-90)" text-anchor="middle">RMSE in metres</text>')
    labels = []
    for r, x, y in sorted(zip(rows, xs, ys), key=lambda point: py(point[2])):
        label = py(y) + 4
        while any(abs(label - ly) < 13 and abs(px(x) - lx) < 190 for lx, ly in labels):
            label += 2
        labels.append((px(x), label))
        colour = "#c0392b" if r["method"].startswith("dem ") else "#34495e"
        out.append(f'<circle cx="{px(x):.1f}" cy="{py(y):.1f}" r="5" stroke="{colour}" stroke-width="2" '
                   f'fill="{colour if r["method"].startswith("dem ") else "white"}"/>'
                   f'<text x="{px(x) + 9:.1f}" y="{label:.1f}" fill="{colour}">{r["method"]}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def print_table(rows):
    print(f"\n{'method':28} {'RMSE m':>9} {'MAE m':>9} {'max m':>9} {'CPU s':>9}  outcome")
    for r in rows:
        numbers = [f"{r[k]:9.3f}" if k in r else f"{'-':>9}" for k in ("rmse_m", "mae_m", "max_m", "cpu_s")]
        print(f"{r['method']:28} {' '.join(numbers)}  {r['outcome']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truth", metavar="TRUTH")
    parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
    parser.add_argument("--sample", default="--keep 3.4%", help="what `dem sample` is told")
    parser.add_argument("--only", default="", metavar="REGEX", help="compare only the methods whose name matches")
    parser.add_argument("--repeat", type=int, default=1, metavar="N")
    parser.add_argument("--timeout", type=float, default=300, metavar="SECONDS", help="for each program")
    parser.add_argument("--dem", default=str(ROOT / "build/release/apps/dem/dem"), metavar="PROGRAM")
    args = parser.parse_args()
    args.truth, args.dem = os.path.abspath(args.truth), shlex.quote(os.path.abspath(args.dem))

    args.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="compare") as shared:
        problem = pose_problem(args, pathlib.Path(shared))
        rows = []
        for name, commands in contestants(args.dem, problem).items():
            if re.search(args.only, name):
                print(f"{name} ...", flush=True)
                rows.append(measure(name, commands, problem, args))
    rows.sort(key=lambda r: r.get("rmse_m", math.inf))

    print_table(rows)
    with open(args.folder / "compare.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, ["method", "rmse_m", "mae_m", "max_m", "cpu_s", "wall_s", "outcome"])
        table.writeheader()
        table.writerows(rows)
    title = f"{pathlib.Path(args.truth).name}, dem sample {args.sample}"
    scored = [r for r in rows if "rmse_m" in r]
    known, kept = (int(numpy.count_nonzero(~numpy.isnan(problem[k]))) for k in ("truth", "heights"))
    kept_part = {"kept_percent": round(100 * kept / known, 3), "kept_cells": kept}
    (args.folder / "compare.json").write_text(
        json.dumps({"title": title, "scores": [kept_part | r for r in scored]}, indent=1) + "\n", encoding="utf-8")
    if scored:
        (args.folder / "compare.svg").write_text(picture(scored, title), encoding="utf-8")
    print(f"\n{args.folder / 'compare.csv'}\n{args.folder / 'compare.svg'}")


if __name__ == "__main__":
    main()
