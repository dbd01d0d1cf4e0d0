#!/usr/bin/env python3
"""A new fill method, planted in a copy of the tree in the places that CONTRIBUTING lists, is found in
every door: the command line, its manual and completion, the docs, Python, C, and its need of memory.

    planted_method.py WORK

WORK: a folder of its own. It is kept: a second run compiles only what has changed.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPIED = ["CMakeLists.txt", "CONTRIBUTING.md", "LICENSE", "REFERENCES.md", "apps", "docs", "libdem", "scripts"]

HEADER = """\
#pragma once
// A method for a test: every unknown cell gets one height.

#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

struct ToyOptions {
  double height_m = 5;
};
std::vector<Field> fields(ToyOptions& options);

Raster<float> fill_toy(const Dem& dem, const ToyOptions& options = {}, const Run& run = {});

}  // namespace dem
"""
SOURCE = """\
#include "dem/toy.h"

namespace dem {

std::vector<Field> fields(ToyOptions& o) {
  return {{"height", o.height_m, {0, 100}, "m", "of every unknown cell"}};
}

Raster<float> fill_toy(const Dem& dem, const ToyOptions& options, const Run&) {
  check_fillable(dem);
  check_options(options);
  Raster<float> z = dem.z;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    if (!dem.known.cells()[i]) z.cells()[i] = float(options.height_m);
  return z;
}

}  // namespace dem
"""
ROW = """\
      make_method<ToyOptions>("toy", "one height everywhere", "toy2026", {%s}, {}, fill_toy),
"""
TRAITS = ".bytes_per_cell = 123456"
C_PROGRAM = """\
#include <stdio.h>
#include "libdem.h"
int main(void) {
  for (size_t i = 0; i < libdem_method_count(); ++i) puts(libdem_method_name(i));
  return 0;
}
"""
C_BUILD = """
enable_language(C)
add_executable(names names.c)
target_link_libraries(names PRIVATE dem_io)
"""
HOLED = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -1\n" + "1 1 1\n1 -1 1\n1 1 1\n"


def write(path, text):
    """Leaves a file that is the same untouched, so that nothing is compiled twice."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def put_before(text, mark, added):
    assert text.count(mark) == 1, f"{mark!r} stands {text.count(mark)} times"
    return text.replace(mark, added + mark)


def planted():
    """The files that differ from the tree's, by their path in it."""
    def read(name):
        return (ROOT / name).read_text(encoding="utf-8")

    table = "libdem/src/methods/methods.cpp"
    row = put_before(read(table), "  };\n  return table;\n", ROW % TRAITS)
    return {
        "libdem/include/dem/toy.h": HEADER,
        "libdem/src/fillers/toy.cpp": SOURCE,
        "libdem/CMakeLists.txt": put_before(read("libdem/CMakeLists.txt"), "  src/fillers/contours.cpp\n",
                                            "  src/fillers/toy.cpp\n"),
        table: put_before(row, '#include "methods/find_row.h"\n', '#include "dem/toy.h"\n'),
        "REFERENCES.md": read("REFERENCES.md") + "\n- **[toy2026]** A toy.\n",
        # Not part of a method: the program that asks in C.
        "names.c": C_PROGRAM,
        "CMakeLists.txt": read("CMakeLists.txt") + C_BUILD,
    }


def make_tree(tree):
    changed = planted()
    wanted = set(changed)
    for top in COPIED:
        files = [ROOT / top] if (ROOT / top).is_file() else (ROOT / top).rglob("*")
        for file in files:
            name = file.relative_to(ROOT).as_posix()
            if not file.is_file() or "__pycache__" in name:
                continue
            wanted.add(name)
            to = tree / name
            if name in changed or to.exists() and to.read_bytes() == file.read_bytes():
                continue
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, to)
    for name, text in changed.items():
        write(tree / name, text)
    for old in [f for f in tree.rglob("*") if f.is_file() and f.relative_to(tree).as_posix() not in wanted]:
        old.unlink()


def run(*command, status=0, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    assert done.returncode == status, f"{command}: {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done.stdout + done.stderr


def build(tree, to):
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    run("cmake", "-G", "Ninja", "-S", tree, "-B", to, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O0",
        "-DDEM_BUILD_TESTS=OFF", "-DDEM_BUILD_BENCH=OFF", *launcher)
    run("cmake", "--build", to, "--target", "dem_cli", "names")
    if (to / "apps/python").exists():
        targets = run("cmake", "--build", to, "--target", "help")
        if "dem_python_package" in targets:
            run("cmake", "--build", to, "--target", "dem_python_package")


def check_command_line(dem, work):
    assert "toy  one height everywhere [toy2026]" in run(dem, "methods")
    row = json.loads(run(dem, "methods", "toy", "--json"))["fill"][0]
    assert row["bytes_per_cell"] == 123456 and row["fields"][0]["name"] == "height", row
    holed, out = work / "holed.asc", work / "out.asc"
    write(holed, HOLED)
    run(dem, "fill", holed, out, "-m", "toy", "-s", "height=7", "-q", "--overwrite")
    assert "7" in out.read_text().split()[-5], out.read_text()
    for line in run(dem, "fill", holed, out, "-m", "toy", "-s", "height=101", status=1).splitlines():
        assert "height = 101; must be a number in [0, 100]" in line, line
    assert "toy" in run(dem, "fill", "--help")
    assert "toy" in run(dem, "manual", "fill")
    for shell in "bash", "zsh", "fish":
        assert "toy" in run(dem, "completion", shell), shell


def check_memory(dem, work):
    """At 123456 bytes a cell, 200M are refused with what would do; `nearest` can do with them."""
    rows = "\n".join(" ".join("1" if col % 199 == 0 or row % 199 == 0 else "-1" for col in range(200))
                     for row in range(200))
    write(work / "wide.asc", HOLED.replace("ncols 3\nnrows 3", "ncols 200\nnrows 200").split("1 1 1")[0] + rows + "\n")
    command = [dem, "fill", work / "wide.asc", work / "wide.tif", "--memory", "200M", "--overwrite", "-m"]
    assert re.search(r"memory = 200M; must be at least \d.*G for", run(*command, "toy", status=1))
    run(*command, "nearest")


def check_docs(tree, dem):
    run(tree / "scripts/docs.sh", "--check", dem, status=1)  # the pages do not have it yet
    made = run(dem, "manual", "fill", "--format", "markdown")
    assert "toy" in made and "toy" not in (tree / "docs/fill.md").read_text(encoding="utf-8")


PYTHON = """
import numpy, libdem
method = libdem.methods()["toy"]
assert method.bytes_per_cell == 123456 and method.fields[0].name == "height", method
z = numpy.ones((3, 3), "float32")
z[1, 1] = numpy.nan
assert libdem.fill(z, method="toy", height=7.0).elevation[1, 1] == 7
assert "toy" in libdem.fill.__doc__
"""


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    work = pathlib.Path(sys.argv[1]).resolve()
    tree, made = work / "tree", work / "build"
    make_tree(tree)
    run(sys.executable, tree / "scripts/check_layers.py", tree)
    build(tree, made)
    dem = made / "apps/dem/dem"
    check_command_line(dem, work)
    check_memory(dem, work)
    check_docs(tree, dem)
    assert "toy" in run(made / "names").split()
    package = made / "apps/python/libdem"
    if package.exists():
        assert "'toy'" in (package / "__init__.pyi").read_text()
        python = next(line.split("=")[1] for line in (made / "CMakeCache.txt").read_text().splitlines()
                      if line.startswith("DEM_PYTHON:"))
        run(python, "-c", PYTHON, env={**os.environ, "PYTHONPATH": str(package.parent)})
    else:
        print("the Python package is not built here: its door was not tried")
    # A row that does not state its memory does not compile.
    table = tree / "libdem/src/methods/methods.cpp"
    write(table, table.read_text(encoding="utf-8").replace(TRAITS, ""))
    assert "MethodTraits" in run("cmake", "--build", made, "--target", "dem", status=1)


if __name__ == "__main__":
    main()
