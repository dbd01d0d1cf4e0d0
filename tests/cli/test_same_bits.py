"""A dozen fills, grids and generators come out as they did before the house was rebuilt, to the bit.

    DEM_BINARY=dem tests/cli/test_same_bits.py --write    prints the table anew
"""

import hashlib
import os
import pathlib
import subprocess
import sys
import unittest

from support import DEM, CliTest, hgt_bytes, main

TILE = str(pathlib.Path(__file__).parents[2] / "testdata" / "jacksboro.tif")

# What makes each raster, and the SHA-256 of its cells. {tile}: the whole tile; {holes}: with voids of 5 % of its
# cells; {sparse}: 3.4 % of its cells; {lines}: its contour lines; {points}: a list of points.
CASES = [
    ("fill {holes} {out}", "76b08d90fc4f49dc"),
    ("fill {holes} {out} --whole", "5188842cfb3b507d"),
    ("fill {holes} {out} -m mcmd", "ee48f34956e941fb"),
    ("fill {holes} {out} -m idw", "f67b89b5d3b923a3"),
    ("fill {holes} {out} -m mcmd:paper --inner-only", "3d5428ecc40bf50b"),
    ("fill {holes} {out} --roughness auto --seed 7", "ce9c8a60ada89985"),
    ("fill {holes} {out} --memory 300M --max-area-km2 3", "349ed81d2d4981de"),
    ("fill {sparse} {out}", "fb04ec7b874ab0fe"),
    ("fill {sparse} {out} -m mcmd", "72808da12f6eb433"),
    ("fill {lines} {out} -m contours", "50760fc149faabd8"),
    ("grid {points} {out} --cell 30m --to-crs EPSG:32616", "d113b83408de4b94"),
    ("grid {points} {out} --like {tile} -m mcmd --passes 3", "2f31e79f55a2f6ec"),
    ("supersample {tile} {out} -f 2", "91e0055da135ede5"),
    ("sample {tile} {out} --edges 5%", "9dfb8e5075a22c23"),
    ("generate noise {out} --size 200x150 -s seed=3", "d3e1cc34e24d2e43"),
    ("generate faults {out} --size 128x128", "9035bafd3810981f"),
    ("generate riverland {out} --size 128x128", "665248f02fce8f06"),
    ("erode {tile} {out} -s steps=20", "9fec37ff85921e92"),
]


def dem(*words):
    return subprocess.run([DEM, *words, "--overwrite"], capture_output=True, text=True)


def inputs(folder):
    """The files that the commands of CASES begin with."""
    files = {name: os.path.join(folder, name + ".tif") for name in ("holes", "sparse", "lines")}
    files["tile"] = TILE
    samples = {"holes": ("--voids", "5%"), "sparse": ("--keep", "3.4%"), "lines": ("--contours", "20")}
    for name, words in samples.items():
        done = dem("sample", TILE, files[name], *words, "--seed", "1")
        assert done.returncode == 0, done.stderr
    files["points"] = os.path.join(folder, "points.csv")
    with open(files["points"], "w") as out:
        out.write("x,y,z\n")
        n = 12345
        for _ in range(3000):
            n = (n * 1103515245 + 12345) % 2 ** 31
            u = n / 2 ** 31
            n = (n * 1103515245 + 12345) % 2 ** 31
            v = n / 2 ** 31
            x, y = -84.41 + 0.33 * u, 36.45 + 0.28 * v
            out.write(f"{x:.9f},{y:.9f},{300 + 80 * u * v + 40 * ((7 * u + 5 * v) % 1):.4f}\n")
    return files


def checksum(command, folder, files):
    out, raw = os.path.join(folder, "out.tif"), os.path.join(folder, "raw.img")
    done = dem(*command.format(out=out, **files).split())
    if done.returncode not in (0, 3):
        return done.stderr
    done = dem("fill", out, raw, "--format", "ENVI", "--max-area-km2", "1e-9", "--type", "float32")
    if done.returncode not in (0, 3):
        return done.stderr
    return hashlib.sha256(pathlib.Path(raw).read_bytes()).hexdigest()[:16]


@unittest.skipIf(os.environ.get("DEM_SANITIZED"), "another compiler's -O1: one build is enough")
class SameBits(CliTest):
    def test_every_raster_is_what_it_was(self):
        files = inputs(self.dir)
        for command, expected in CASES:
            with self.subTest(command):
                self.assertEqual(checksum(command, self.dir, files), expected)


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        import tempfile
        with tempfile.TemporaryDirectory() as made:
            ready = inputs(made)
            for case, _ in CASES:
                print(f'    ("{case}", "{checksum(case, made, ready)}"),')
    else:
        main()
