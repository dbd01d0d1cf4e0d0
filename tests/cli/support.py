"""Small inputs made by hand, and one way to call the command line."""

import math
import os
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

DEM = os.path.abspath(os.environ.get("DEM_BINARY", "dem"))
VOID = -32768


def height(col, row):
    """A smooth hill with some waves, in whole metres."""
    return round(300 + 80 * math.sin(col / 7) + 60 * math.cos(row / 5) + col)


def hgt_bytes(side, value=height):
    cells = (value(c, r) for r in range(side) for c in range(side))
    return struct.pack(f">{side * side}h", *cells)


def read_hgt(path):
    with open(path, "rb") as file:
        data = file.read()
    return struct.unpack(f">{len(data) // 2}h", data)


def asc_text(rows, nodata=-9999):
    head = f"ncols {len(rows[0])}\nnrows {len(rows)}\nxllcorner 0\nyllcorner 0\ncellsize 10\n"
    if nodata is not None:
        head += f"NODATA_value {nodata}\n"
    return head + "".join(" ".join(str(v) for v in row) + "\n" for row in rows)


def vrt_text(types, size=4):
    bands = "".join(f'<VRTRasterBand dataType="{t}" band="{i + 1}"/>' for i, t in enumerate(types))
    return f'<VRTDataset rasterXSize="{size}" rasterYSize="{size}">{bands}</VRTDataset>'


def raw_vrt_text(name, size):
    """A square of little-endian floats in the file `name`."""
    return (f'<VRTDataset rasterXSize="{size}" rasterYSize="{size}">'
            '<VRTRasterBand dataType="Float32" band="1" subClass="VRTRawRasterBand">'
            f'<SourceFilename relativeToVRT="1">{name}</SourceFilename>'
            f'<ImageOffset>0</ImageOffset><PixelOffset>4</PixelOffset><LineOffset>{4 * size}</LineOffset>'
            '<ByteOrder>LSB</ByteOrder></VRTRasterBand></VRTDataset>')


def limit_file_size(limit):
    def limiter():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return limiter


def limit_memory(limit):
    def limiter():
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    return limiter


class CliTest(unittest.TestCase):
    def setUp(self):
        self.dir = tempfile.mkdtemp(prefix="dem-cli-")
        self.addCleanup(shutil.rmtree, self.dir)

    def path(self, name):
        return os.path.join(self.dir, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def hgt(self, name="N10E010.hgt", side=33, value=height):
        return self.write(name, hgt_bytes(side, value))

    def holed(self, name="N10E010.hgt", side=33):
        """A hill with one void inside and one at the border."""

        def value(c, r):
            inner, border = 10 <= c < 14 and 20 <= r < 23, c < 3 and r < 2
            return VOID if inner or border else height(c, r)

        return self.hgt(name, side, value)

    def dem(self, *arguments, env=None, **options):
        environment = {**os.environ, **(env or {})}
        return subprocess.run([DEM, *arguments], capture_output=True, text=True, cwd=self.dir,
                              env=environment, timeout=120, **options)

    def succeeds(self, *arguments, **options):
        done = self.dem(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def fails(self, code, *arguments, says=(), **options):
        """The exit code, and one line on stderr that says each of `says`."""
        done = self.dem(*arguments, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assert_one_error_line(done.stderr, says)
        self.assertEqual(done.stdout, "")
        return done

    def assert_one_error_line(self, stderr, says=()):
        self.assertEqual(stderr.count("\n"), 1, stderr)
        self.assertTrue(stderr.startswith("dem: "), stderr)
        for words in says:
            self.assertIn(words, stderr)

    def assert_files(self, *names):
        """The folder holds these files and nothing else: no half-written output."""
        self.assertEqual(sorted(os.listdir(self.dir)), sorted(names))


def slow(test):
    """Marks a test, or all tests of a class, that takes seconds: ctest gives it the label `slow`."""
    test.slow = True
    return test


class Chosen(unittest.TestLoader):
    """Loads the slow tests, or those that are not."""

    def __init__(self, want_slow):
        super().__init__()
        self.want_slow = want_slow

    def getTestCaseNames(self, case):
        def is_slow(name):
            return getattr(case, "slow", False) or getattr(getattr(case, name), "slow", False)

        return [name for name in super().getTestCaseNames(case) if is_slow(name) == self.want_slow]


def main():
    """Runs the tests of a file: all, or those that its only argument names, `fast` or `slow`."""
    which = sys.argv[1:]
    if which not in ([], ["fast"], ["slow"]):
        sys.exit(f"usage: {sys.argv[0]} [fast|slow]")
    loader = Chosen(which == ["slow"]) if which else unittest.defaultTestLoader
    unittest.main(argv=sys.argv[:1], verbosity=1, testLoader=loader)
