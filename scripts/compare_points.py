#!/usr/bin/env python3
"""Compares `dem grid` and the methods for points and contour lines with GDAL, GMT, GRASS and SAGA.

    scripts/compare_points.py contours TRUTH:INTERVAL ...     contour lines cut from a DEM, middle 512 x 512 cells
    scripts/compare_points.py random TRUTH ...                1, 3.4 and 10 % of its cells at random, the same part
    scripts/compare_points.py speed POINTS SIDE               a CSV of so many points onto SIDE x SIDE cells

Prints the tables of ACCURACY.md, section "Points and contour lines". RMSE is over the cells that were not
given. Peak: how often the cells between contour lines have heights within a twentieth of the interval
around the commonest remainder, over the mean; 1 is flat, and the truth's own is in its row. CPU seconds are
user plus system time of all commands from the file of points to a raster, reading included. A program
gets 600 CPU seconds and 8 GB of address space (--cpu, --memory); what it did not finish is said.
Needs python3-numpy and python3-gdal, and `dem` (--dem, default build/release/apps/dem/dem).
"""
import argparse
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from compare import Failed, describe_problem, read, write, GRASS, GRASS_IN, GRASS_OUT, NC_TO_TIF, SAGA_OUT, ROOT

SIDE = 512  # cells of the part of a truth that is looked at

# name: (program, commands); each runs in a folder with in.tif (known cells), points.bin, points.csv and points.vrt.
GMT_SURFACE = "gmt surface {points} -bi3d -R0/{last_col}/0/{last_row} -I1 -T%s -Gfilled.nc"
GDAL_GRID = ("gdal_grid -q -txe 0 {cols} -tye {rows} 0 -outsize {cols} {rows} -ot Float32 -of GTiff -a %s "
             "-l points {vrt} filled.tif")
SAGA_MBA = ("saga_cmd -f=s grid_spline 4 -SHAPES points.shp -FIELD Z -METHOD 0 -TARGET_DEFINITION 0 "
            "-TARGET_USER_SIZE {cell} -TARGET_USER_XMIN {first} -TARGET_USER_XMAX {last_x} -TARGET_USER_YMIN {first} "
            "-TARGET_USER_YMAX {last_y} -TARGET_USER_FITS 0 -TARGET_OUT_GRID filled.sgrd")
SAGA_POINTS = "saga_cmd -f=s io_shapes 3 -FILENAME points.txt -HEADLINE 1 -POINTS points.shp"
DEM_FILL = "{dem} fill {in} filled.tif --quiet --threads 1 --type float32 --method %s"
INVDIST = "invdistnn:radius={search}:max_points=12:nodata=-9999"

GIVEN_CELLS = {
    "dem spline": ("dem", [DEM_FILL % "spline"]),
    "gmt surface -T0": ("gmt", [GMT_SURFACE % 0, *NC_TO_TIF]),
    "gmt surface -T0.25": ("gmt", [GMT_SURFACE % 0.25, *NC_TO_TIF]),
    "gdal_grid linear": ("gdal_grid", [GDAL_GRID % "linear:radius=-1:nodata=-9999"]),
    "gdal_grid invdistnn": ("gdal_grid", [GDAL_GRID % INVDIST]),
    "saga MBA": ("saga_cmd", [SAGA_POINTS, SAGA_MBA, *SAGA_OUT]),
}
CONTOURS = {
    "dem contours": ("dem", [DEM_FILL % "contours"]),
    "dem spline": ("dem", [DEM_FILL % "spline"]),
    "dem mcmd, two_sided": ("dem", [DEM_FILL % "mcmd -s two_sided=true"]),
    "dem mcmd": ("dem", [DEM_FILL % "mcmd"]),
    "grass r.surf.contour": ("grass", [*GRASS_IN, GRASS + "r.surf.contour input=dem output=filled", *GRASS_OUT]),
    "gmt surface -T0": ("gmt", [GMT_SURFACE % 0, *NC_TO_TIF]),
    "gmt surface -T0.25": ("gmt", [GMT_SURFACE % 0.25, *NC_TO_TIF]),
}
SPEED = {
    "dem grid -m mcmd": ("dem", ["{dem} grid points.csv filled.tif --quiet --threads 1 {lattice} -m mcmd"]),
    "dem grid": ("dem", ["{dem} grid points.csv filled.tif --quiet --threads 1 {lattice}"]),
    "gdal_grid linear": ("gdal_grid", [GDAL_GRID % "linear:radius=-1:nodata=-9999"]),
    "gdal_grid invdistnn": ("gdal_grid", [GDAL_GRID % INVDIST]),
    "gmt blockmean, surface -T0.25": ("gmt", [
        "gmt blockmean points.csv -h1 -R0/{cols}/0/{rows} -I1 -r > means.txt",
        "gmt surface means.txt -R0/{cols}/0/{rows} -I1 -r -T0.25 -Gfilled.nc", *NC_TO_TIF]),
    "saga MBA": ("saga_cmd", [SAGA_POINTS, SAGA_MBA, *SAGA_OUT]),
}


def run(command, folder, limits):
    """Runs one shell line within limits; returns its CPU seconds."""
    def confine():
        resource.setrlimit(resource.RLIMIT_CPU, (int(limits["cpu"]), int(limits["cpu"]) + 5))
        resource.setrlimit(resource.RLIMIT_AS, (limits["memory"], limits["memory"]))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(["bash", "-c", command], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", preexec_fn=confine, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if cpu >= limits["cpu"] - 1:
        raise Failed(f"stopped after {limits['cpu']} CPU seconds")
    if done.returncode != 0:
        raise Failed(f"exit code {done.returncode}: {' '.join(done.stdout.split())[-160:]}")
    return cpu


def surface_of(commands, problem, folder, limits):
    """Lets one contestant work; returns its heights and its CPU seconds."""
    cpu = sum(run(c.format(**problem), folder, limits) for c in commands)
    return read(folder / "filled.tif"), cpu


def contest(contestants, problem, shared, limits):
    """Yields name, heights, CPU seconds and, when there are no heights, why."""
    for name, (program, commands) in contestants.items():
        if not re.search(limits["only"], name):
            continue
        if program != "dem" and not shutil.which(program):
            yield name, None, 0, f"{program} is not installed"
            continue
        with tempfile.TemporaryDirectory(prefix="compare", dir=shared.parent) as folder:
            folder = pathlib.Path(folder)
            for file in shared.iterdir():
                (folder / file.name).symlink_to(file)
            try:
                yield name, *surface_of(commands, problem, folder, limits), ""
            except Failed as why:
                yield name, None, 0, str(why)


def rmse(error):
    """Of the cells that have a height, and the part of them that has none."""
    whole = ~numpy.isnan(error)
    return float(numpy.sqrt(numpy.mean(error[whole] ** 2))), 1 - whole.mean()


def part_of(path, folder):
    """The middle of a truth, as a raster of square cells of size 1; holes take the mean."""
    z = read(path)
    top, left = (max(0, (n - SIDE) // 2) for n in z.shape)
    part = z[top:top + SIDE, left:left + SIDE]
    part = numpy.where(numpy.isnan(part), numpy.nanmean(part), part)
    write(folder / "truth.tif", part)
    return part


def pose(dem, truth, sample, folder):
    """Cells of a truth that are given, and the names in command lines."""
    subprocess.run(shlex.split(f"{dem} sample truth.tif sampled.tif --quiet --overwrite {sample}"), cwd=folder,
                   check=True)
    z = read(folder / "sampled.tif")
    problem = {"dem": dem, **describe_problem(z, folder, 1.0)}
    rows, cols = truth.shape
    as_text(folder)
    radius = problem["radius"]
    return z, problem | {"cell": 1, "first": 0.5, "last_x": cols - 0.5, "last_y": rows - 0.5, "search": radius}


def as_text(folder):
    """SAGA wants columns apart by blanks."""
    text = (folder / "points.csv").read_text(encoding="utf-8")
    (folder / "points.txt").write_text(text.replace(",", "\t"), encoding="utf-8")


def peak(z, interval):
    """The commonest remainder of heights by an interval, in windows of a tenth of it, over the mean."""
    parts = numpy.histogram(numpy.mod(z / interval + 0.025, 1), 20, (0, 1))[0]
    two = parts + numpy.roll(parts, 1)
    return float(two.max() / two.mean())


def contours(args, folder, limits):
    print("| terrain | interval | method | RMSE, m | peak | CPU s |\n|---|---:|---|---:|---:|---:|")
    for what in args.what:
        path, interval = what.rsplit(":", 1)
        truth = part_of(path, folder)
        z, problem = pose(args.dem, truth, f"--contours {interval}", folder)
        given, name = ~numpy.isnan(z), pathlib.Path(path).stem
        print(f"| {name} | {interval} m | *the truth* | | {peak(truth[~given], float(interval)):.2f} | |", flush=True)
        for method, filled, cpu, why in contest(CONTOURS, problem, folder, limits):
            if filled is None:
                print(f"| {name} | {interval} m | {method} | {why} | | |", flush=True)
                continue
            error, empty = rmse((filled - truth)[~given])
            note = f" ({100 * empty:.1f} % of the cells empty)" if empty > 0 else ""
            rest = filled[~given & ~numpy.isnan(filled)]
            print(f"| {name} | {interval} m | {method} | {error:.2f}{note} | {peak(rest, float(interval)):.2f} "
                  f"| {cpu:.2f} |", flush=True)


def random(args, folder, limits):
    methods = [m for m in GIVEN_CELLS if re.search(limits["only"], m)]
    print("| terrain | given | " + " | ".join(methods) + " |\n|---|---:|" + "---:|" * len(methods))
    for path in args.what:
        truth = part_of(path, folder)
        for part in ("1%", "3.4%", "10%"):
            z, problem = pose(args.dem, truth, f"--keep {part}", folder)
            given, cells = ~numpy.isnan(z), []
            for _, filled, _, why in contest(GIVEN_CELLS, problem, folder, limits):
                if filled is None:
                    cells.append(why)
                    continue
                error, empty = rmse((filled - truth)[~given])
                cells.append(f"{error:.3g}" + (f" ({100 * empty:.1f} % empty)" if empty > 0 else ""))
            print(f"| {pathlib.Path(path).stem} | {part.replace('%', ' %')} | " + " | ".join(cells) + " |", flush=True)


def ground(x, y):
    """Heights of a made terrain: waves of 1000 down to 8 cells."""
    waves = numpy.random.default_rng(1)
    z = numpy.full(numpy.shape(x), 1000.0)
    for length in 1000 / 2 ** numpy.arange(8):
        for _ in range(3):
            angle, phase = waves.uniform(0, 2 * numpy.pi, 2)
            along = x * numpy.cos(angle) + y * numpy.sin(angle)
            z += 0.08 * length * numpy.sin(2 * numpy.pi * along / length + phase)
    return z


def speed(args, folder, limits):
    points, side = (int(n) for n in args.what)
    places = numpy.random.default_rng(2).uniform(0, side, (points, 2))
    with open(folder / "points.csv", "w", encoding="utf-8") as file:
        file.write("x,y,z\n")
        for part in numpy.array_split(places, max(1, points // 500000)):
            numpy.savetxt(file, numpy.column_stack([part, ground(part[:, 0], part[:, 1])]), "%.3f", ",")
    (folder / "points.vrt").write_text(
        '<OGRVRTDataSource><OGRVRTLayer name="points"><SrcDataSource relativeToVRT="1">points.csv</SrcDataSource>'
        '<GeometryType>wkbPoint25D</GeometryType><GeometryField encoding="PointFromColumns" x="x" y="y" z="z"/>'
        '</OGRVRTLayer></OGRVRTDataSource>', encoding="utf-8")
    as_text(folder)
    centres = numpy.arange(side) + 0.5
    truth = ground(*numpy.meshgrid(centres, centres[::-1]))
    problem = {"dem": args.dem, "cols": side, "rows": side, "vrt": "points.vrt", "cell": 1, "first": 0.5,
               "last_x": side - 0.5, "last_y": side - 0.5, "search": 4 * side / points ** 0.5,
               "lattice": f"--bounds 0,0,{side},{side} --cell 1m"}
    print("| points | lattice | method | RMSE, m | CPU s |\n|---:|---|---|---:|---:|")
    for method, filled, cpu, why in contest(SPEED, problem, folder, limits):
        row = f"| {points:,} | {side} x {side} | {method} | "
        if filled is None:
            print(row + f"{why} | |", flush=True)
            continue
        error, empty = rmse(filled - truth)
        note = f" ({100 * empty:.1f} % empty)" if empty > 0 else ""
        print(row + f"{error:.3f}{note} | {cpu:.1f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=["contours", "random", "speed"])
    parser.add_argument("what", nargs="+")
    parser.add_argument("--cpu", type=float, default=600, metavar="SECONDS")
    parser.add_argument("--memory", type=float, default=8, metavar="GB")
    parser.add_argument("--only", default="", metavar="REGEX", help="only the methods whose name matches")
    parser.add_argument("--dem", default=str(ROOT / "build/release/apps/dem/dem"), metavar="PROGRAM")
    args = parser.parse_args()
    args.dem = shlex.quote(os.path.abspath(args.dem))
    limits = {"cpu": args.cpu, "memory": int(args.memory * 1e9), "only": args.only}
    with tempfile.TemporaryDirectory(prefix="compare") as outer:
        shared = pathlib.Path(outer) / "shared"
        shared.mkdir()
        {"contours": contours, "random": random, "speed": speed}[args.table](args, shared, limits)


if __name__ == "__main__":
    main()
