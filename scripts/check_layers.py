#!/usr/bin/env python3
"""Checks that no #include of libdem/ and apps/ points against the layers of ARCHITECTURE.md.

    scripts/check_layers.py [ROOT]       prints each violation; exit code 1 when there is one
    scripts/check_layers.py --self-test  plants violations and sees that each is found
"""
import pathlib
import re
import sys
import tempfile

# The folders of libdem/src, and the folders whose public headers their files may include. Private headers
# belong to their folder, but for those of numeric, which every folder of the library may use.
BASE = {"values", "numeric"}
MAY_INCLUDE = {
    "values": {"values"},
    "numeric": BASE,
    "midpoint": BASE | {"midpoint"},
    "spline": BASE | {"midpoint", "spline"},  # the solver starts from MCMD's surface
    "fillers": BASE | {"spline", "fillers"},  # the surface between contour lines is a spline within bounds
    "holes": BASE | {"holes"},
    "points": BASE | {"points"},
    "measure": BASE | {"measure"},
    "render": BASE | {"render"},
    "synthesis": BASE | {"midpoint", "synthesis"},  # generators end with MCMD
}
MAY_INCLUDE["methods"] = set().union(*MAY_INCLUDE.values()) | {"methods"}
MAY_INCLUDE["io"] = MAY_INCLUDE["methods"] | {"io"}
MAY_INCLUDE["apps"] = MAY_INCLUDE["io"] - {"numeric"} | {"apps"}

# Other libraries, by the start of what stands between < and >, and the folders whose sources may use them.
# Public headers use the standard library only.
COMPUTING = set(MAY_INCLUDE) - {"values", "io", "apps"}
LIBRARIES = {
    "fmt/": set(MAY_INCLUDE),
    "tbb/": COMPUTING - {"methods"},
    "Eigen/": COMPUTING - {"methods"},
    "unsupported/Eigen/": COMPUTING - {"methods"},
    "gdal": {"io"},
    "cpl_": {"io"},
    "ogr_": {"io"},
    "GeographicLib/": {"io"},
    "OpenImageIO/": {"io"},
    "nlohmann/": {"apps"},
    "pybind11/": {"apps"},
}
# OpenImageIO belongs to the module that is loaded when it is needed; dem::io itself must not link it.
ONE_SOURCE = {"OpenImageIO/": "libdem/src/io/images/oiio_module.cpp"}
POSIX = re.compile(r"(sys/\w+|unistd|fcntl|signal|stdlib|termios|dlfcn|link)\.h")  # io and apps; memory: values
STANDARD = re.compile(r"\w+|std(def|int)\.h")  # the latter for C, in libdem.h
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


class House:
    """Which folder each file belongs to."""

    def __init__(self, root):
        self.root = root
        self.source = root / "libdem" / "src"
        # A public header belongs to the folder that holds the source of its name; one without: values.
        self.folder_of_source = {f.stem: f.relative_to(self.source).parts[0] for f in self.source.rglob("*.cpp")
                                 if f.relative_to(self.source).parts[0] != "io"}

    def folder(self, path):
        """The folder of a file, given by its path below the root; None when it has none."""
        if path.parts[0] == "apps":
            return "apps"
        if path.parts[1] == "src":
            return path.parts[2] if path.parts[2] in MAY_INCLUDE and len(path.parts) > 3 else None
        return self.folder_of_header("/".join(path.parts[2:]))

    def folder_of_header(self, target):
        if target == "libdem.h" or target.startswith("dem/io/"):
            return "io"
        return self.folder_of_source.get(pathlib.PurePosixPath(target).stem, "values")

    def is_private(self, target):
        return (self.source / target).exists()


def fault(house, path, folder, quote, target):
    """What is wrong with one #include, or None."""
    public = path.parts[:2] == ("libdem", "include")
    if quote == '"':
        if target == "libdem.h" or target.startswith("dem/"):
            if not (house.root / "libdem" / "include" / target).exists():
                return f"there is no {target}"
            other = house.folder_of_header(target)
            return None if other in MAY_INCLUDE[folder] else f"{folder} must not include {target} ({other})"
        if folder == "apps":
            return "apps must not include the private " + target if house.is_private(target) else None
        if public:
            return f"a public header must not include the private {target}"
        if not house.is_private(target):
            return f"there is no libdem/src/{target}; a private header is included with its folder"
        other = target.split("/")[0]
        if other == folder or other == "numeric" and "numeric" in MAY_INCLUDE[folder]:
            return None
        return f"{folder} must not include {target} ({other})"
    if STANDARD.fullmatch(target):
        return None
    if public:
        return f"a public header must not include <{target}>"
    if POSIX.fullmatch(target):
        allowed = folder in {"io", "apps"} or target == "sys/mman.h" and folder == "values"
        return None if allowed else f"{folder} must not include <{target}>"
    for start, source in ONE_SOURCE.items():
        if target.startswith(start) and path.as_posix() != source:
            return f"only {source} may include <{target}>"
    for start, folders in LIBRARIES.items():
        if target.startswith(start):
            return None if folder in folders else f"{folder} must not include <{target}>"
    return f"<{target}> is not in the table of libraries"


def violations(root):
    """All violations below `root`, one line of text each."""
    found = []
    files = [f for d in ("libdem", "apps") for f in sorted((root / d).rglob("*"))
             if f.suffix in {".h", ".cpp"}]
    if not files:
        found.append(f"{root}: no source in libdem/ and apps/")
    house = House(root)
    for file in files:
        path = file.relative_to(root)
        folder = house.folder(path)
        if folder is None:
            found.append(f"{path}: lies in no folder that scripts/check_layers.py knows")
            continue
        text = file.read_text(encoding="utf-8")
        for match in INCLUDE.finditer(text):
            if message := fault(house, path, folder, *match.groups()):
                found.append(f"{path}:{text.count(chr(10), 0, match.start(1)) + 1}: {message}")
    return found


# A small house for the self-test: public headers, a private one, and the sources that give headers their folder.
HOUSE = ["libdem/include/dem/raster.h", "libdem/include/dem/mcmd.h", "libdem/include/dem/sample.h",
         "libdem/include/dem/methods.h", "libdem/include/dem/spline.h", "libdem/include/dem/dem.h",
         "libdem/include/dem/io/rasters.h", "libdem/include/dem/io/methods.h", "libdem/src/values/raster.cpp",
         "libdem/src/midpoint/mcmd.cpp", "libdem/src/midpoint/lattice.h", "libdem/src/measure/sample.cpp",
         "libdem/src/spline/spline.cpp", "libdem/src/methods/methods.cpp", "libdem/src/numeric/parallel.h",
         "libdem/src/io/raster/rasters.cpp"]


def self_test():
    """Each planted violation must be found, and each allowed #include must pass."""
    planted = [
        ("libdem/include/dem/raster.h", '#include "dem/mcmd.h"'),
        ("libdem/include/dem/raster.h", '#include "dem/io/rasters.h"'),
        ("libdem/include/dem/io/rasters.h", "#include <gdal_priv.h>"),
        ("libdem/include/dem/mcmd.h", '#include "numeric/parallel.h"'),
        ("libdem/include/dem/mcmd.h", "#include <fmt/format.h>"),
        ("libdem/src/midpoint/mcmd.cpp", '#include "dem/sample.h"'),
        ("libdem/src/midpoint/mcmd.cpp", '#include "dem/spline.h"'),
        ("libdem/src/midpoint/mcmd.cpp", '#include "dem/methods.h"'),
        ("libdem/src/midpoint/mcmd.cpp", '#include "dem/io/rasters.h"'),
        ("libdem/src/midpoint/mcmd.cpp", "#include <GeographicLib/Geodesic.hpp>"),
        ("libdem/src/measure/sample.cpp", "  #  include <cpl_conv.h>"),
        ("libdem/src/numeric/parallel.h", '#include "dem/mcmd.h"'),
        ("libdem/src/measure/sample.cpp", '#include "midpoint/lattice.h"'),
        ("libdem/src/midpoint/mcmd.cpp", '#include "lattice.h"'),
        ("libdem/src/methods/methods.cpp", '#include "midpoint/lattice.h"'),
        ("libdem/src/methods/methods.cpp", '#include "dem/io/methods.h"'),
        ("libdem/src/methods/methods.cpp", "#include <unistd.h>"),
        ("libdem/src/io/raster/rasters.cpp", "#include <boost/any.hpp>"),
        ("libdem/src/io/raster/rasters.cpp", "#include <OpenImageIO/imageio.h>"),
        ("libdem/src/unheard_of/mcmd.cpp", "#include <vector>"),
        ("libdem/src/loose.cpp", "#include <vector>"),
        ("libdem/src/io/raster/rasters.cpp", '#include "dem/unheard_of.h"'),
        ("apps/dem/main.cpp", "#include <gdal.h>"),
        ("apps/dem/main.cpp", '#include "numeric/parallel.h"'),
    ]
    allowed = [
        ("libdem/include/dem/mcmd.h", '#include "dem/dem.h"\n#include <vector>'),
        ("libdem/src/midpoint/mcmd.cpp",
         '#include "dem/mcmd.h"\n#include "numeric/parallel.h"\n#include <tbb/task_arena.h>'),
        ("libdem/src/midpoint/mcmd.cpp", '#include "dem/mcmd.h"\n#include "midpoint/lattice.h"'),
        ("libdem/src/methods/methods.cpp", '#include "dem/mcmd.h"'),
        ("libdem/src/io/methods.cpp", '#include "dem/io/methods.h"\n#include <gdal_alg.h>'),
        ("libdem/src/io/images/oiio_module.cpp", "#include <OpenImageIO/imageio.h>"),
        ("apps/dem/main.cpp", '#include "progress.h"\n#include "dem/io/rasters.h"\n#include <fmt/format.h>'),
    ]
    for cases, count in (planted, 1), (allowed, 0):
        for path, text in cases:
            with tempfile.TemporaryDirectory() as folder:
                root = pathlib.Path(folder)
                for name in HOUSE:
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).touch()
                file = root / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text + "\n", encoding="utf-8")
                found = violations(root)
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
