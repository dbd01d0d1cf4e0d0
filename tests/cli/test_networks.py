#!/usr/bin/env python3
"""dem generate from drawings: ridges and rivers, painted land, sketches. DEM_BINARY is the executable to test."""

import json

from support import CliTest, main

SIDE = 129


def pgm(grey, side=SIDE):
    """A grey image; grey(col, row) from 0 to 255."""
    cells = bytes(grey(c, r) for r in range(side) for c in range(side))
    return f"P5 {side} {side} 255\n".encode() + cells


def lines(col, row):
    """A river down the middle, a ridge across the top."""
    return 60 if col == 64 and row > 40 else 190 if row == 20 and 10 < col < 120 else 255


def island(col, row):
    inside = (col - 64) ** 2 + (row - 64) ** 2 < 58 ** 2
    return 0 if not inside else 128 if col > 90 else 255


def feature(kind, shape, coordinates, **more):
    return {"type": "Feature", "properties": {"kind": kind, **more},
            "geometry": {"type": shape, "coordinates": coordinates}}


def geojson(*features):
    return json.dumps({"type": "FeatureCollection", "features": list(features)})


class Networks(CliTest):
    def heights(self, name):
        rows = [line.split() for line in self.read(name).decode().splitlines()]
        return [[float(v) for v in row] for row in rows if len(row) > 2]

    def test_a_drawn_river_never_rises_toward_its_mouth(self):
        self.write("lines.pgm", pgm(lines))
        self.succeeds("generate", "skeleton", "lines.pgm", "x.asc")
        z = self.heights("x.asc")
        for row in range(42, SIDE):
            self.assertLessEqual(z[row][64], z[row - 1][64])
        self.assertGreater(z[20][64], z[41][64])

    def test_lines_come_from_a_vector_layer_too(self):
        self.write("lines.geojson", geojson(feature("river", "LineString", [[64, -40], [64, -200]]),
                                            feature("ridge", "LineString", [[10, -20], [120, -20]])))
        self.succeeds("generate", "skeleton", "lines.geojson", "x.asc", "--size", str(SIDE), "--cell", "1",
                      "-s", "river_slope=0.5", "-s", "ridge_slope=1")
        z = self.heights("x.asc")
        for row in range(42, SIDE):
            self.assertLess(z[row][64], z[row - 1][64])
        self.assertAlmostEqual(z[20][50], 20, places=3)  # 20 cells from the edge

    def test_painted_land_is_above_the_sea_and_the_sea_at_0(self):
        self.write("island.pgm", pgm(island))
        ring = [[600, -600], [3300, -600], [3300, -3300], [600, -3300], [600, -600]]
        self.write("island.geojson", geojson(feature("land", "Polygon", [ring])))
        for name in ("island.pgm", "island.geojson"):
            with self.subTest(name):
                self.succeeds("generate", "painted_land", name, "x.asc", "--size", str(SIDE), "--cell", "30",
                              "--origin", "0,0", "--overwrite", *(["-s", "segment_m=300"]))
                z = self.heights("x.asc")
                self.assertEqual(z[2][2], 0)
                self.assertGreater(max(map(max, z)), 20)

    def test_a_drawn_ridge_rises_above_painted_land(self):
        ring = [[600, -600], [3300, -600], [3300, -3300], [600, -3300], [600, -600]]
        line = [[1500, -1900], [2400, -1900]]
        words = ["x.asc", "--size", str(SIDE), "--cell", "30", "--origin", "0,0", "--overwrite", "-s", "segment_m=300"]
        highest = []
        for height in (50, 800):
            self.write("ridge.geojson", geojson(feature("land", "Polygon", [ring]),
                                                feature("ridge", "LineString", line, height_m=height, width_m=400)))
            self.succeeds("generate", "painted_land", "ridge.geojson", *words)
            z = self.heights("x.asc")
            highest.append(max(z[row][65] for row in range(55, 75)))
        self.assertGreater(highest[1], highest[0] + 300)
        self.write("ridge.geojson", geojson(feature("land", "Polygon", [ring]),
                                            feature("ridge", "LineString", line, height_m=80)))
        done = self.dem("generate", "painted_land", "ridge.geojson", *words)
        self.assertEqual(done.returncode, 2)
        self.assertIn("ridge 1: height_m = 80, width_m = 0; must both be above 0", done.stderr)

    def test_a_sketch_keeps_its_heights_and_the_median_smooths_the_wall(self):
        self.write("wall.pgm", pgm(lambda c, r: 100 if 60 < c < 70 else 255))
        self.succeeds("generate", "sketch", "wall.pgm", "x.asc")
        self.assertAlmostEqual(self.heights("x.asc")[5][65], 100, places=3)

        def roughness(name):
            z = self.heights(name)
            return sum(abs(a - b) for row in z for a, b in zip(row, row[1:]))

        self.succeeds("generate", "sketch:wall", "wall.pgm", "rough.asc")
        self.succeeds("generate", "sketch:wall", "wall.pgm", "smooth.asc", "--median", "2")
        self.assertLess(roughness("smooth.asc"), 0.8 * roughness("rough.asc"))

    def test_bad_drawings_are_one_line(self):
        self.write("white.pgm", pgm(lambda c, r: 255))
        self.write("black.pgm", pgm(lambda c, r: 0))
        self.write("dot.pgm", pgm(lambda c, r: 0, 1))
        self.write("points.geojson", geojson(feature("river", "Point", [3, -3])))
        self.write("odd.geojson", geojson(feature("road", "LineString", [[3, -3], [9, -9]])))
        for arguments, says in [
            (["skeleton", "white.pgm", "x.tif"], "all white"),
            (["skeleton", "black.pgm", "x.tif"], "no white"),
            (["skeleton", "dot.pgm", "x.tif"], "size = 1 x 1"),
            (["sketch", "white.pgm", "x.tif"], "all white"),
            (["sketch", "black.pgm", "x.tif"], "no white"),
            (["painted_land", "black.pgm", "x.tif"], "no land"),
            (["painted_land", "white.pgm", "x.tif", "-s", "segment_m=20000"], "no room for a river"),
            (["ridges", "x.tif", "--size", "2"], "size = 2 x 2"),
            (["riverland", "x.tif", "--size", "1"], "size = 1 x 1"),
            (["lsystem", "x.tif", "-s", "rewrites=0"], "draws nothing"),
            (["sketch", "x.tif"], "needs an image"),
        ]:
            with self.subTest(arguments):
                self.fails(1, "generate", *arguments, says=[says])
        self.fails(2, "generate", "skeleton", "points.geojson", "x.tif", says=["must be a line or a polygon"])
        self.fails(2, "generate", "skeleton", "odd.geojson", "x.tif", says=['kind = "road"'])


if __name__ == "__main__":
    main()
