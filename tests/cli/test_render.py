"""What `dem render` promises, and how it refuses."""

import json
import struct

from support import CliTest, asc_text, main, slow


def png_shape(data):
    """Width, height and channels of a PNG."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, _, kind = struct.unpack(">IIBB", data[16:26])
    return width, height, {0: 1, 2: 3}[kind]


class Render(CliTest):
    def test_maps_have_a_pixel_for_each_cell(self):
        self.holed()
        for style, channels in ("hillshade", 1), ("relief", 3):
            self.succeeds("render", "N10E010.hgt", f"{style}.png", "--style", style)
            self.assertEqual(png_shape(self.read(f"{style}.png")), (33, 33, channels))

    def test_a_view_has_the_size_asked_for(self):
        self.holed()
        done = self.succeeds("render", "N10E010.hgt", "v.png", "--style", "view", "--size", "64x48", "--json")
        self.assertEqual(png_shape(self.read("v.png")), (64, 48, 3))
        facts = json.loads(done.stdout)
        self.assertEqual((facts["style"], facts["width"], facts["height"]), ("view", 64, 48))
        self.assertGreaterEqual(facts["exaggeration"], 1)

    @slow
    def test_options_change_the_picture_and_threads_do_not(self):
        self.hgt()
        pictures = {}
        for options in ((), ("--azimuth", "90"), ("--altitude", "20"), ("--exaggeration", "3"),
                        ("--palette", "desert"), ("--multidirectional",)):
            self.succeeds("render", "N10E010.hgt", "o.png", *options, "--overwrite")
            pictures[self.read("o.png")] = options
        self.assertEqual(len(pictures), 6)
        view = ("render", "N10E010.hgt", "v.png", "--style", "view", "--size", "64x48", "--overwrite")
        views = set()
        for options in ((), ("--heading", "90"), ("--tilt", "60"), ("--no-shadows",), ("--haze", "5"), ("--fov", "60"),
                        ("--palette", "dusk"), ("--samples", "9")):
            self.succeeds(*view, *options)
            views.add(self.read("v.png"))
        self.assertEqual(len(views), 8)
        self.succeeds(*view, *options, "--threads", "1")
        self.assertIn(self.read("v.png"), views)

    def test_the_camera_stands_in_the_coordinates_of_the_dem(self):
        self.write("a.asc", asc_text([[100] * 20] * 20))  # x and y from 0 to 200
        view = ("render", "a.asc", "v.png", "--style", "view", "--size", "32x32", "--overwrite")
        self.succeeds(*view, "--camera", "100,100,150", "--target", "190,190,100")
        absolute = self.read("v.png")
        self.succeeds(*view, "--camera", "100,100,+50", "--target", "190,190,+0")
        self.assertEqual(self.read("v.png"), absolute)

    def test_a_camera_underground_is_told_how_high_to_go(self):
        self.write("a.asc", asc_text([[100] * 20] * 20))
        self.fails(1, "render", "a.asc", "v.png", "--style", "view", "--camera", "100,100,60",
                   says=["camera is 40.0 m under the ground", "higher than 100.0 m"])
        self.fails(1, "render", "a.asc", "v.png", "--style", "view", "--camera", "900,100,+60",
                   says=["camera = 900,100,+60", "no known ground below"])
        self.assert_files("a.asc")

    def test_bad_options_are_told_before_the_dem_is_read(self):
        for options, says in (
                (("--palette", "rainbow"), ["palette = rainbow", "one of atlas, alpine"]),
                (("--azimuth", "north"), ["azimuth = north", "a number in [-360, 360]"]),
                (("--altitude", "91"), ["altitude = 91", "[0, 90]"]),
                (("--tilt", "20"), ["tilt", "is not for style relief"]),
                (("--size", "64x48"), ["size is for --style view"]),
                (("--camera", "1,2,3"), ["camera is for --style view"]),
                (("--style", "cubist"), ["cubist"]),
                (("--style", "view", "--multidirectional"), ["multidirectional", "is not for style view"]),
                (("--style", "view", "--size", "big"), ["size = big", "1600x900"]),
                (("--style", "view", "--size", "0x9"), ["width = 0", "[16, 16384]"]),
                (("--style", "view", "--samples", "0"), ["samples = 0"]),
                (("--style", "view", "--fov", "180"), ["fov = 180"])):
            self.fails(1, "render", "none.tif", "o.png", *options, says=says)
        self.assert_files()

    def test_bad_points_are_told(self):
        self.hgt()
        for point in ("1,2", "a,b,c", "1,2,3,4"):
            self.fails(1, "render", "N10E010.hgt", "v.png", "--style", "view", "--camera", point,
                       says=["camera = ", "must be X,Y,Z"])
        self.fails(1, "render", "N10E010.hgt", "v.png", "--style", "view", "--target", "10.5,10.5,9",
                   says=["target without"])

    def test_files_that_cannot_be_read_or_written_are_told(self):
        self.hgt()
        self.fails(2, "render", "none.tif", "o.png", says=["none.tif"])
        self.fails(2, "render", "N10E010.hgt", "no/such/folder.png", says=["no/such"])
        self.fails(2, "render", "N10E010.hgt", "o.xyz", says=["o.xyz"])
        self.succeeds("render", "N10E010.hgt", "o.png")
        self.fails(2, "render", "N10E010.hgt", "o.png", says=["o.png", "exists"])
        self.assert_files("N10E010.hgt", "o.png")

    def test_a_single_row_of_cells_is_no_view(self):
        self.write("a.asc", asc_text([[1, 2, 3, 4]]))
        self.fails(1, "render", "a.asc", "v.png", "--style", "view", says=["4 x 1 cells", "at least 2 x 2"])

    def test_help_lists_the_palettes(self):
        text = self.succeeds("render", "--help").stdout
        for palette in ("atlas", "alpine", "desert", "dusk", "paper"):
            self.assertRegex(text, rf"\n  {palette} +\w")


if __name__ == "__main__":
    main()
