#!/usr/bin/env python3
"""From the results of `dem reproduce mount-washington FOLDER` to README's table and picture.

    scripts/figures.py FOLDER   (scripts/figures.sh calls it)
"""
import csv
import pathlib
import sys

import numpy
from osgeo import gdal

gdal.UseExceptions()

ROOT = pathlib.Path(__file__).resolve().parents[1]
RATES = ["50", "10", "3.4", "1"]
SIDE = 300  # cells of the picture, from the middle of the tile, where the summit is
BEGIN, END = "<!-- figures: begin -->\n", "<!-- figures: end -->\n"


def table(scores):
    """RMSE and time of each method at a few rates, in Markdown."""
    by = {(s["method"], s["kept_percent"]): s for s in scores}
    methods = list(dict.fromkeys(s["method"] for s in scores))
    lines = ["| method | " + " | ".join(f"{r} % kept" for r in RATES) + " |", "|---" + "|---:" * len(RATES) + "|"]
    for method in methods:
        cells = [by[method, rate] for rate in RATES]
        lines.append(f"| `{method}` | " + " | ".join(
            f"{float(s['rmse_m']):.2f} m, {1000 * float(s['wall_s']):.0f} ms" for s in cells) + " |")
    return "\n".join(lines) + "\n"


def picture(folder):
    """What was known, what MCMD and the spline make of it, and the truth, side by side."""
    panels = []
    for name in ("sampled.png", "mcmd_default.png", "spline.png", "truth.png"):
        grey = gdal.Open(str(folder / name)).ReadAsArray()
        rgb = grey if grey.ndim == 3 else numpy.stack([grey] * 3)
        side = min(SIDE, *rgb.shape[1:])
        top, left = (rgb.shape[1] - side) // 2, (rgb.shape[2] - side) // 2
        panels += [rgb[:, top:top + side, left:left + side], numpy.full((3, side, 6), 255, numpy.uint8)]
    strip = numpy.concatenate(panels[:-1], axis=2)
    raster = gdal.GetDriverByName("MEM").Create("", strip.shape[2], strip.shape[1], 3, gdal.GDT_Byte)
    raster.WriteArray(strip)
    out = ROOT / "mount-washington.jpg"
    gdal.GetDriverByName("JPEG").CreateCopy(str(out), raster, options=["QUALITY=80"])
    out.with_suffix(".jpg.aux.xml").unlink(missing_ok=True)


def main():
    folder = pathlib.Path(sys.argv[1])
    with open(folder / "curves.csv", newline="", encoding="utf-8") as file:
        rows = table(list(csv.DictReader(file)))
    readme = ROOT / "README.md"
    before, rest = readme.read_text(encoding="utf-8").split(BEGIN)
    readme.write_text(before + BEGIN + rows + END + rest.split(END)[1], encoding="utf-8")
    picture(folder)
    print(f"{readme}\n{ROOT / 'mount-washington.jpg'}")


if __name__ == "__main__":
    main()
