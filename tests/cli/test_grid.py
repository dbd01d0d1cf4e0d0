"""What `dem grid` promises: points of any kind to a DEM, and one line for what is wrong."""

import json
import math

from support import CliTest, asc_text, main


def plane(x, y):
    return 100 + 2 * x - 3 * y


def csv(points, head="x,y,z\n"):
    return head + "".join(f"{x},{y},{z}\n" for x, y, z in points)


class Grid(CliTest):
    def points(self, name="p.csv", **more):
        """Points of a plane, on and off the centres of cells of 10 m."""
        places = [(x, y) for x in range(3, 200, 17) for y in range(8, 150, 13)]
        return self.write(name, csv([(x, y, plane(x, y)) for x, y in places], **more))

    def grid(self, *arguments, **options):
        return json.loads(self.succeeds("grid", *arguments, "--json", **options).stdout)

    def heights(self, name):
        rows = self.read(name).decode().splitlines()
        rows = [line.split() for line in rows if line.strip()[0] in "-0123456789"]
        return [[float(v) for v in row] for row in rows]

    def test_a_plane_comes_out_as_it_was(self):
        self.points()
        facts = self.grid("p.csv", "g.asc", "--bounds", "0,0,200,150", "--cell", "10m")
        self.assertEqual((facts["cols"], facts["rows"], facts["outside"]), (20, 15, 0))
        for r, row in enumerate(self.heights("g.asc")):
            for c, z in enumerate(row):
                self.assertAlmostEqual(z, plane(5 + 10 * c, 145 - 10 * r), delta=0.01)

    def test_standard_input_is_a_dash(self):
        with open(self.points(), encoding="utf-8") as file:
            text = file.read()
        facts = self.grid("-", "g.tif", "--cell", "10m", input=text)
        self.assertEqual(facts["points"], text.count("\n") - 1)

    def test_without_a_lattice_the_density_chooses(self):
        self.points()
        facts = self.grid("p.csv", "g.tif")
        self.assertEqual(facts["cell_m"], [5, 5])  # points are about 15 m apart
        self.assertIn("mean distance", facts["lattice_from"])

    def test_like_takes_another_lattice_and_counts_points_outside(self):
        self.points()
        self.write("like.asc", asc_text([[1, 2, 3]] * 4))  # 30 x 40 m at the origin
        facts = self.grid("p.csv", "g.asc", "--like", "like.asc", "--no-fill")
        self.assertEqual((facts["cols"], facts["rows"]), (3, 4))
        self.assertEqual(facts["points"] - facts["outside"], 2 * 3)

    def test_every_method_fills(self):
        self.points()
        names = json.loads(self.succeeds("methods", "--json").stdout)
        for method in [m["name"] for m in names["fill"]]:
            self.grid("p.csv", "g.asc", "--cell", "10m", "-m", method, "--overwrite")
            self.assertTrue(all(0 < z + 500 < 1500 for row in self.heights("g.asc") for z in row), method)

    def test_duplicates_outliers_and_empty_rows_are_counted(self):
        rows = [(x, y, plane(x, y)) for x in range(0, 200, 10) for y in range(0, 150, 10)]
        rows += [(50, 50, 999), (71, 71, 32767), (80, 80, "nan")]
        self.write("p.csv", csv(rows))
        done = self.succeeds("grid", "p.csv", "g.tif", "--cell", "10m", "--reject-outliers", "10", "--json",
                             "--combine", "min")
        facts = json.loads(done.stdout)
        self.assertEqual((facts["duplicates"], facts["without_z"]), (1, 1))
        self.assertEqual(facts["outlier_cells"], 0)  # the lowest of two points is no outlier
        facts = self.grid("p.csv", "g.tif", "--cell", "10m", "--reject-outliers", "10", "--overwrite")
        self.assertEqual(facts["outlier_cells"], 1)

    def test_sigma_of_the_surface_is_written(self):
        self.points()
        self.succeeds("grid", "p.csv", "g.asc", "--cell", "10m", "--sigma", "s.asc")
        self.assertTrue(all(0 <= s < 50 for row in self.heights("s.asc") for s in row))


class Contours(CliTest):
    def lines(self, name="c.geojson"):
        """Circles around (500, 500): a cone of 1 m in 5, with a line every 20 m."""
        features = []
        for level in range(20, 100, 20):
            radius = 5 * (100 - level)
            ring = [[500 + radius * math.cos(a / 30), 500 + radius * math.sin(a / 30)] for a in range(190)]
            features.append({"type": "Feature", "properties": {"height": level},
                             "geometry": {"type": "LineString", "coordinates": ring}})
        return self.write(name, json.dumps({"type": "FeatureCollection", "features": features}))

    def test_the_surface_between_lines_has_no_terraces(self):
        self.lines()
        grid = ["grid", "c.geojson", "g.asc", "--contours", "--crs", "EPSG:32632", "--bounds", "0,0,1000,1000"]
        facts = json.loads(self.succeeds(*grid, "--cell", "10m", "--json").stdout)
        self.assertEqual((facts["cols"], facts["rows"], facts["method"]), (100, 100, "contours"))
        rows = [line.split() for line in self.read("g.asc").decode().splitlines() if line[0] not in "ncxydN"]
        for r in range(100):
            for c in range(100):
                distance = math.hypot(5 + 10 * c - 500, 995 - 10 * r - 500)
                if 120 < distance < 380:
                    self.assertAlmostEqual(float(rows[r][c]), 100 - distance / 5, delta=2)
        self.assertTrue(83 < float(rows[50][50]) < 100)  # above the last line, below the next

    def test_what_they_need(self):
        self.write("p.csv", csv([(1, 2, 3), (5, 9, 3)]))
        self.fails(1, "grid", "p.csv", "g.tif", "--contours", says=["--contours needs --cell"])
        self.fails(2, "grid", "p.csv", "g.tif", "--contours", "--cell", "1m", says=["vector layer of lines"])
        flat = {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"name": "a"}, "geometry": {
            "type": "LineString", "coordinates": [[8, 46], [9, 47]]}}]}
        self.write("n.geojson", json.dumps(flat))
        self.fails(2, "grid", "n.geojson", "g.tif", "--contours", "--cell", "1s",
                   says=["has no elevations", "--z-field"])


class Breaklines(CliTest):
    """Two terraces, 100 m apart, with a wall at x = 203."""

    def setUp(self):
        super().setUp()
        places = [(x, y) for x in range(4, 400, 19) for y in range(3, 300, 17)]
        self.write("p.csv", csv([(x, y, 0 if x < 203 else 100) for x, y in places]))
        self.layer("wall.geojson", "LineString", [[203, -50], [203, 350]])

    def layer(self, name, kind, coordinates):
        return self.write(name, json.dumps({"type": "Feature", "properties": {}, "geometry": {
            "type": kind, "coordinates": coordinates}}))

    def grid(self, *arguments):
        done = self.succeeds("grid", "p.csv", "g.asc", "--bounds", "0,0,400,300", "--cell", "10m", "--overwrite",
                             *arguments)
        rows = [line.split() for line in self.read("g.asc").decode().splitlines() if line[0] not in "ncxydN"]
        return done, [[float(z) for z in row] for row in rows]

    def test_the_surface_jumps_at_a_line(self):
        _, smooth = self.grid()
        _, cut = self.grid("--breaklines", "wall.geojson")
        self.assertTrue(all(1 < max(abs(z) for z in row[18:20]) for row in smooth))
        for row in cut:
            for col, z in enumerate(row):
                self.assertAlmostEqual(z, 0 if col < 20 else 100, delta=0.01)

    def test_an_area_without_points_is_named(self):
        self.layer("pond.geojson", "Polygon", [[[61, 61], [61, 74], [74, 74], [74, 61], [61, 61]]])
        done, heights = self.grid("--breaklines", "pond.geojson")
        self.assertIn("close off 1 cell around x 65, y 65 without a point", done.stderr)
        self.assertAlmostEqual(heights[23][6], 0, delta=1)

    def test_what_is_wrong_is_one_line(self):
        grid = ["grid", "p.csv", "g.tif", "--cell", "10m", "--breaklines"]
        self.fails(2, *grid, "none.gpkg", says=["none.gpkg"])
        self.layer("far.geojson", "LineString", [[9000, 0], [9000, 9]])
        self.fails(2, *grid, "far.geojson", says=["none of its lines passes between two cells"])
        self.layer("point.geojson", "Point", [3, 4])
        self.fails(2, *grid, "point.geojson", says=["holds no line and no polygon"])
        self.fails(1, *grid, "wall.geojson", "-m", "mcmd", says=["method mcmd knows none", "spline"])


class BadInput(CliTest):
    def test_each_is_one_line_that_says_what_would_be_right(self):
        cases = {
            "": ["is empty"],
            "x,y,z\n": ["holds no points"],
            "x,y,z\n1,2,x3\n": ["line 2", "z = x3"],
            "x,y,z\n1,2,3\n": ["1 point covers no area", "bounds and cell"],
            "x,y,z\n1,2,3\n4,2,3\n": ["2 points cover no area"],
            "lon,lat,z\n46,121,3\n": ["wrong way round"],
            "a,b,c\n1,2,3\n": ["--x-field", "a, b, c"],
        }
        for text, says in cases.items():
            self.write("p.csv", text)
            done = self.dem("grid", "p.csv", "g.tif")
            self.assertIn(done.returncode, (1, 2), text)
            for words in says:
                self.assertIn(words, done.stderr.splitlines()[-1])
            self.assert_files("p.csv")

    def test_a_raster_is_no_file_of_points(self):
        self.write("p.csv", csv([(1, 2, 3), (30, 20, 4)]))
        self.succeeds("grid", "p.csv", "r.tif", "--cell", "10m")
        self.fails(2, "grid", "r.tif", "g.tif", says=["is a raster"])

    def test_heights_of_no_planet_are_warned_of(self):
        self.write("p.csv", csv([(1, 2, 3), (8, 9, 1e9), (30, 20, 4)]))
        done = self.succeeds("grid", "p.csv", "g.tif", "--cell", "5m")
        self.assertIn("with elevations beyond 30000 m; --reject-outliers", done.stderr)

    def test_points_off_the_lattice(self):
        self.write("p.csv", csv([(10, 500, 1), (20, 600, 2)]))
        self.fails(2, "grid", "p.csv", "g.tif", "--bounds", "400,0,700,30", "--cell", "10m",
                   says=["none of its 2 points", "with x and y swapped"])
        self.fails(2, "grid", "p.csv", "g.tif", "--bounds", "4000,0,7000,30", "--cell", "10m", says=["none of its 2"])

    def test_options_that_do_not_go_together(self):
        self.write("p.csv", csv([(10, 500, 1)]))
        self.fails(1, "grid", "p.csv", "g.tif", "--bounds", "0,0,9,9", says=["--bounds needs --cell"])
        self.fails(1, "grid", "p.csv", "g.tif", "--cell", "30ells", says=["30 or 30m"])
        self.fails(1, "grid", "p.csv", "g.tif", "--like", "a.tif", "--cell", "30m", says=["--like says it all"])
        self.fails(1, "grid", "p.csv", "g.tif", "-s", "nonsense=1", says=["nonsense"])
        self.fails(1, "grid", "p.csv", "g.tif", "--no-fill", "--sigma", "s.tif", says=["--no-fill"])
        self.fails(2, "grid", "none.csv", "g.tif", says=["none.csv"])


if __name__ == "__main__":
    main()
