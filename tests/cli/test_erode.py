#!/usr/bin/env python3
"""dem erode: what it writes, and what it says of bad input. DEM_BINARY is the executable to test."""

import json

from support import CliTest, asc_text, main


class Erode(CliTest):
    def facts(self, name):
        return json.loads(self.succeeds("info", "--json", name).stdout)["files"][0]

    def test_erodes_what_generate_made_and_says_how_much_left(self):
        self.succeeds("generate", "noise", "hills.tif", "--size", "65")
        done = self.succeeds("erode", "hills.tif", "out.tif", "-s", "steps=100", "--json")
        report = json.loads(done.stdout)
        gone = report["before_m3"] - report["after_m3"] - report["carried_m3"]
        self.assertLess(abs(gone), 1e-9 * abs(report["before_m3"]) + 1)
        self.assertGreater(report["carried_m3"], 0)
        self.assertEqual(self.facts("out.tif")["unknown_cells"], 0)

    def test_real_tiles_erode_and_unknown_cells_stay_unknown(self):
        self.holed()
        self.succeeds("erode", "N10E010.hgt", "out.tif", "-s", "steps=20")
        before, after = self.facts("N10E010.hgt"), self.facts("out.tif")
        self.assertEqual(before["unknown_cells"], after["unknown_cells"])
        self.assertGreater(after["unknown_cells"], 0)
        self.assertNotEqual(before["high_m"], after["high_m"])

    def test_threads_do_not_change_the_output(self):
        self.succeeds("generate", "noise", "hills.tif", "--size", "100x150")
        for threads in "12":
            self.succeeds("erode", "hills.tif", f"{threads}.asc", "-s", "steps=50", "-j", threads)
        self.assertEqual(self.read("1.asc"), self.read("2.asc"))

    def test_frames_and_water(self):
        self.succeeds("generate", "noise", "hills.tif", "--size", "33")
        self.succeeds("erode", "hills.tif", "out.tif", "-s", "steps=100", "--frames", "film", "--every", "40",
                      "--water", "water.tif")
        for name in ("film/step_000040.tif", "film/step_000080.tif", "water.tif"):
            self.assertEqual(self.facts(name)["cols"], 33)
        self.fails(2, "erode", "hills.tif", "new.tif", "-s", "steps=100", "--frames", "film", "--every", "40",
                   says=["step_000040.tif"])

    def test_bad_input_is_one_line(self):
        self.succeeds("generate", "noise", "hills.tif", "--size", "9")
        for arguments, says in [
            (["-s", "talus_deg=-1"], "talus_deg = -1; must be a number in [0, 89]"),
            (["-s", "steps=-1"], "steps = -1"),
            (["-s", "speed=1"], "unknown setting"),
            (["--every", "0"], "0"),
        ]:
            with self.subTest(says):
                self.fails(1, "erode", "hills.tif", "out.tif", *arguments, says=[says])
        self.write("void.asc", asc_text([[-9999, -9999]]))
        self.fails(2, "erode", "void.asc", "out.tif", says=["no known cell"])
        self.assert_files("hills.tif", "void.asc")


if __name__ == "__main__":
    main()
