#!/usr/bin/env python3
"""dem generate: what it makes, and what it says of bad input. DEM_BINARY is the executable to test."""

import json

from support import CliTest, main, slow


class Generate(CliTest):
    def facts(self, name):
        return json.loads(self.succeeds("info", "--json", name).stdout)["files"][0]

    def table(self):
        return json.loads(self.succeeds("methods", "--json").stdout)["generators"]

    @slow
    def test_every_generator_and_preset_makes_a_dem_without_holes(self):
        for row in self.table():
            if row["image"]:
                continue
            for name in [row["name"]] + [f"{row['name']}:{p['name']}" for p in row["presets"]]:
                with self.subTest(name):
                    cell = [] if row["globe"] else ["--cell", "300"]
                    self.succeeds("generate", name, "x.tif", "--size", "40x20", *cell, "--overwrite")
                    facts = self.facts("x.tif")
                    self.assertEqual((facts["cols"], facts["rows"], facts["unknown_cells"]), (40, 20, 0))
                    self.assertLess(facts["low_m"], facts["high_m"])

    def test_size_cell_crs_and_origin_say_where_it_lies(self):
        done = self.succeeds("generate", "noise", "x.tif", "--size", "30x20", "--cell", "10x20", "--crs", "EPSG:32619",
                             "--origin", "305000,4910000", "--json")
        made = json.loads(done.stdout)
        self.assertEqual((made["cols"], made["rows"], made["cell_m"]), (30, 20, [10, 20]))
        text = self.succeeds("info", "x.tif").stdout
        for words in ("30 x 20", "UTM zone 19N"):
            self.assertIn(words, text)

    def test_cell_takes_units_and_crs_takes_a_number(self):
        self.succeeds("generate", "noise", "m.tif", "--size", "9", "--cell", "30m", "--crs", "32619")
        self.assertEqual(self.facts("m.tif")["cell_crs"], [30, 30])
        self.succeeds("generate", "noise", "s.tif", "--size", "9", "--cell", "1s", "--crs", "4326", "--origin", "9,47")
        self.assertEqual(self.facts("s.tif")["cell_crs"], [1 / 3600, 1 / 3600])
        self.fails(1, "generate", "noise", "x.tif", "--cell", "1s", says=["--cell = 1s", "degrees"])

    def test_a_part_of_a_terrain_has_the_heights_of_the_whole(self):
        self.succeeds("generate", "noise", "whole.asc", "--size", "8", "--origin", "0,210")
        self.succeeds("generate", "noise", "part.asc", "--size", "4", "--origin", "120,90")
        last = [line.split()[-4:] for line in self.read("whole.asc").decode().splitlines()[-4:]]
        part = [line.split() for line in self.read("part.asc").decode().splitlines()[-4:]]
        for a, b in zip(sum(last, []), sum(part, [])):
            self.assertAlmostEqual(float(a), float(b), places=3)

    def test_seed_and_settings_change_the_terrain_and_threads_do_not(self):
        def made(name, *arguments):
            self.succeeds("generate", "noise", name, "--size", "65", *arguments)
            return self.read(name)

        base = made("a.asc")
        self.assertEqual(base, made("b.asc", "-j", "1"))
        self.assertEqual(base, made("s.asc", "--seed", "1"))
        self.assertNotEqual(base, made("c.asc", "--seed", "2"))
        self.assertNotEqual(base, made("d.asc", "-s", "H=0.5"))

    def test_bad_input_is_one_line(self):
        for arguments, says in [
            (["nois", "x.tif"], "unknown generator"),
            (["noise:nothing", "x.tif"], "unknown preset"),
            (["noise", "x.tif", "--size", "0"], "size = 0"),
            (["noise", "x.tif", "--size", "-3"], "size = -3"),
            (["noise", "x.tif", "--size", "1000000"], "must have 1 to"),
            (["noise", "x.tif", "--cell", "0"], "cell = 0"),
            (["noise", "x.tif", "--crs", "EPSG:0"], "crs = EPSG:0"),
            (["noise", "x.tif", "--origin", "7"], "origin = 7"),
            (["noise", "x.tif", "-s", "octaves=0"], "octaves = 0"),
            (["noise", "x.tif", "-s", "octave=3"], "unknown setting"),
            (["noise", "x.tif", "-s", "octaves=48"], "too fine"),
            (["noise", "image.png", "x.tif"], "unexpected argument"),
        ]:
            with self.subTest(says):
                self.fails(1, "generate", *arguments, says=[says])
        self.assert_files()

    def test_existing_output_is_kept(self):
        self.write("x.tif", "mine")
        self.fails(2, "generate", "noise", "x.tif", "--size", "9", says=["x.tif"])
        self.assertEqual(self.read("x.tif"), b"mine")

    def test_sizes_of_one_and_two_cells_work(self):
        for size in ("1", "2", "1x7"):
            self.succeeds("generate", "noise", "x.tif", "--size", size, "--overwrite")


if __name__ == "__main__":
    main()
