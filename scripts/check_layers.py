#!/usr/bin/env python3
"""Checks that no #include of libdem/ and apps/ points against the layers of ARCHITECTURE.md.

    scripts/check_layers.py [ROOT]       prints each violation; exit code 1 when there is one
    scripts/check_layers.py --self-test  plants violations and sees that each is found
"""
import pathlib
import re
import sys
import tempfile

# The layer of each file. A header dem/NAME.h and its source NAME.cpp share a name and a layer.
LAYERS = {
    "values": ["breaklines", "canvas", "dem", "fields", "palette", "raster", "river", "run"],
    "helpers": ["cubic", "envelope", "flood", "gradient", "lie_together", "parallel", "paths", "random", "vectorised"],  # private: for any algorithm
    "algorithms": ["baseline", "breakdown", "contours", "deterrace", "draw", "erosion", "evaluate", "faults", "hole_parts", "holes", "mcmd", "networks",
                   "noise", "outliers", "points", "raytrace", "riverland", "sample", "sketch", "spline"],
    "methods": ["find_row", "generators", "greedy", "gridding", "methods", "supersample"],
    "io": ["aligned_reader", "baselines", "cells", "crs", "drawing", "gdal_raster", "gdal_support", "geodesy", "heightmap",
           "hgt", "image", "io", "las", "lattices", "libdem", "nodata", "ogr_layers", "oiio_support", "point_files",
           "point_reading", "point_text", "point_vectors", "polygons", "raster_stream", "raster_writer", "staged_file", "tile_folder"],
}

# An algorithm that is written in several private files. They belong to it alone.
PARTS = {
    "holes": ["hole_filter", "hole_scan", "hole_windows"],
    "mcmd": ["contour_sides", "lattice", "midpoint", "pyramid", "row_kernels", "waves"],
    "networks": ["growth", "ridges", "rivers"],
    "raytrace": ["heightfield", "sky", "view"],
    "spline": ["cuts", "grid", "multigrid", "overshoot", "roughness", "spline_parameters", "spline_sample", "spline_solver",
               "springs", "tensor"],
    "riverland": ["riverland_heights", "riverland_parts", "riverland_relief", "riverland_rivers"],
    "sketch": ["lsystem"],
}

# The algorithms that call another: the spline's solver starts from MCMD's surface, generators end
# with it, and the surface between contour lines is a spline that is held within bounds. Holes of parts become
# holes of the whole.
CALLS = {("spline", "mcmd"), ("spline_parameters", "mcmd"), ("roughness", "mcmd"), ("networks", "mcmd"),
         ("riverland_relief", "mcmd"), ("sketch", "mcmd"), ("lsystem", "mcmd"), ("contours", "spline"), ("hole_parts", "holes")}

# The layers that each layer may include. Algorithms do not include each other: they compose
# through data.
MAY_INCLUDE = {
    "values": {"values"},
    "helpers": {"values", "helpers"},
    "algorithms": {"values", "helpers"},
    "methods": {"values", "helpers", "algorithms", "methods"},
    "io": {"values", "helpers", "algorithms", "methods", "io"},
    "apps": {"values", "algorithms", "methods", "io", "apps"},
}

# Other libraries, by the start of what stands between < and >, and the layers whose sources may
# use them. Public headers use the standard library only.
LIBRARIES = {
    "fmt/": {"values", "helpers", "algorithms", "methods", "io", "apps"},
    "tbb/": {"helpers", "algorithms"},
    "Eigen/": {"helpers", "algorithms"},
    "unsupported/Eigen/": {"helpers", "algorithms"},
    "gdal": {"io"},
    "cpl_": {"io"},
    "ogr_": {"io"},
    "GeographicLib/": {"io"},
    "OpenImageIO/": {"io"},
    "CLI/": {"apps"},
    "nlohmann/": {"apps"},
    "pybind11/": {"apps"},
}
POSIX = re.compile(r"(sys/\w+|unistd|fcntl|signal|stdlib|termios)\.h")  # the operating system: io and apps; memory: values
STANDARD = re.compile(r"\w+|std(def|int)\.h")  # the latter for C, in libdem.h

OWNER = {part: owner for owner, parts in PARTS.items() for part in parts}
LAYER_OF = {name: layer for layer, names in LAYERS.items() for name in names} | dict.fromkeys(OWNER, "algorithms")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def layer_of(path):
    """The layer of a file, given by its path below the root; None when the table lacks it."""
    return "apps" if path.parts[0] == "apps" else LAYER_OF.get(path.stem)


def fault(path, layer, quote, target):
    """What is wrong with one #include, or None."""
    public = path.parts[:3] == ("libdem", "include", "dem")
    if quote == '"':
        if layer == "apps" and not target.startswith("dem/"):
            return None  # a neighbour in the same folder
        name = pathlib.PurePosixPath(target).stem
        other = LAYER_OF.get(name)
        if other is None:
            return f"{target} is not in the table of layers"
        if OWNER.get(name, name) == OWNER.get(path.stem, path.stem):
            return None  # its own header, or within one algorithm
        if (path.stem, name) in CALLS:
            return None
        if name in OWNER or other not in MAY_INCLUDE[layer]:
            return f"{layer} must not include {target} ({other})"
        if public and not target.startswith("dem/"):
            return f"a public header must not include the private {target}"
        return None
    if STANDARD.fullmatch(target):
        return None
    if public:
        return f"a public header must not include <{target}>"
    if POSIX.fullmatch(target):
        return None if layer in {"io", "apps"} or target == "sys/mman.h" and layer == "values" else f"{layer} must not include <{target}>"
    for start, layers in LIBRARIES.items():
        if target.startswith(start):
            return None if layer in layers else f"{layer} must not include <{target}>"
    return f"<{target}> is not in the table of libraries"


def violations(root):
    """All violations below `root`, one line of text each."""
    found = []
    files = [f for d in ("libdem", "apps") for f in sorted((root / d).rglob("*"))
             if f.suffix in {".h", ".cpp"}]
    if not files:
        found.append(f"{root}: no source in libdem/ and apps/")
    for file in files:
        path = file.relative_to(root)
        layer = layer_of(path)
        if layer is None:
            found.append(f"{path}: not in the table of layers in scripts/check_layers.py")
            continue
        text = file.read_text(encoding="utf-8")
        for match in INCLUDE.finditer(text):
            if message := fault(path, layer, *match.groups()):
                found.append(f"{path}:{text.count(chr(10), 0, match.start(1)) + 1}: {message}")
    return found


def self_test():
    """Each planted violation must be found, and each allowed #include must pass."""
    planted = [
        ("libdem/include/dem/raster.h", '#include "dem/mcmd.h"'),
        ("libdem/include/dem/io.h", "#include <gdal_priv.h>"),
        ("libdem/include/dem/mcmd.h", '#include "parallel.h"'),
        ("libdem/include/dem/mcmd.h", "#include <fmt/format.h>"),
        ("libdem/src/mcmd.cpp", '#include "dem/sample.h"'),
        ("libdem/src/mcmd.cpp", '#include "dem/spline.h"'),
        ("libdem/src/mcmd.cpp", '#include "dem/methods.h"'),
        ("libdem/src/mcmd.cpp", '#include "dem/io.h"'),
        ("libdem/src/mcmd.cpp", "#include <GeographicLib/Geodesic.hpp>"),
        ("libdem/src/sample.cpp", "  #  include <cpl_conv.h>"),
        ("libdem/src/parallel.h", '#include "dem/mcmd.h"'),
        ("libdem/src/midpoint.h", '#include "dem/sample.h"'),
        ("libdem/src/sample.cpp", '#include "lattice.h"'),
        ("libdem/src/methods.cpp", '#include "lattice.h"'),
        ("libdem/src/methods.cpp", '#include "dem/baselines.h"'),
        ("libdem/src/methods.cpp", "#include <unistd.h>"),
        ("libdem/src/io.cpp", "#include <boost/any.hpp>"),
        ("libdem/src/unheard_of.cpp", "#include <vector>"),
        ("libdem/src/io.cpp", '#include "unheard_of.h"'),
        ("apps/dem/main.cpp", "#include <gdal.h>"),
        ("apps/dem/main.cpp", '#include "dem/parallel.h"'),
    ]
    allowed = [
        ("libdem/include/dem/mcmd.h", '#include "dem/dem.h"\n#include <vector>'),
        ("libdem/src/mcmd.cpp", '#include "dem/mcmd.h"\n#include "parallel.h"\n#include <tbb/task_arena.h>'),
        ("libdem/src/midpoint.h", '#include "dem/mcmd.h"\n#include "lattice.h"'),
        ("libdem/src/methods.cpp", '#include "dem/mcmd.h"'),
        ("libdem/src/baselines.cpp", '#include "dem/methods.h"\n#include <gdal_alg.h>'),
        ("apps/dem/main.cpp", '#include "progress.h"\n#include "dem/io.h"\n#include <CLI/CLI.hpp>'),
    ]
    for cases, count in (planted, 1), (allowed, 0):
        for path, text in cases:
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True)
                file.write_text(text + "\n", encoding="utf-8")
                found = violations(pathlib.Path(folder))
                if len(found) != count:
                    sys.exit(f"self-test: {path} with {text!r}: {found}; must be {count} violations")
    print(f"self-test: {len(planted)} planted violations found, {len(allowed)} allowed files passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = pathlib.Path(sys.argv[1]) if sys.argv[1:] else pathlib.Path(__file__).parents[1]
    found = violations(root)
    if found:
        sys.exit("\n".join(found))
    print("no include points against the layers")


if __name__ == "__main__":
    main()
