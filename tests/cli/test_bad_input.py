"""Bad input, full disks and interruptions: one line, the right exit code, no partial output."""

import os
import random
import signal
import struct
import subprocess
import unittest

from support import DEM, VOID, CliTest, asc_text, height, hgt_bytes, limit_file_size, main, vrt_text


class BadFiles(CliTest):
    def refused(self, name, content, *says):
        self.write(name, content)
        self.fails(2, "fill", name, "out.tif", says=[name, *says])
        self.assert_files(name)

    def test_truncated_hgt_is_refused(self):
        self.refused("N10E010.hgt", hgt_bytes(33)[:-100])

    def test_zero_byte_file_is_refused(self):
        self.refused("N10E010.hgt", b"")

    def test_json_page_saved_as_hgt_is_refused(self):
        self.refused("N10E010.hgt", '{"error": "tile not found"}')

    def test_hgt_that_is_no_square_is_refused(self):
        self.refused("N10E010.hgt", struct.pack(">6h", *range(6)))

    def test_no_known_cell_is_refused(self):
        self.refused("N10E010.hgt", hgt_bytes(9, lambda c, r: VOID), "no known cell")

    def test_text_that_is_no_raster_is_refused(self):
        self.refused("a.tif", "not a raster")

    def test_complex_raster_is_refused(self):
        self.refused("a.vrt", vrt_text(["CFloat32"]), "real numbers")

    def test_raster_of_several_bands_needs_band(self):
        self.refused("a.vrt", vrt_text(["Float32", "Float32"]), "band")

    def test_band_beyond_the_last_is_refused(self):
        self.write("a.vrt", vrt_text(["Float32", "Float32"]))
        self.fails(2, "fill", "a.vrt", "out.tif", "--band", "3", says=["a.vrt", "band"])

    def test_missing_file_is_refused(self):
        self.fails(2, "info", "nowhere.tif", says=["nowhere.tif"])
        self.assert_files()

    def test_files_of_different_sizes_cannot_be_compared(self):
        self.write("a.asc", asc_text([[1, 2], [3, 4]]))
        self.write("b.asc", asc_text([[1, 2]]))
        self.fails(2, "evaluate", "a.asc", "b.asc", says=["b.asc", "2 x 1", "2 x 2"])

    def test_reproduce_without_its_tile_says_where_to_get_it(self):
        self.fails(2, "reproduce", "mount-washington", "out", says=["N44W072", "--tile"],
                   env={"DEM_TESTDATA": self.dir})
        self.assert_files()


class BadOutput(CliTest):
    def test_existing_output_is_kept_without_overwrite(self):
        self.holed()
        self.write("out.tif", "mine")
        self.fails(2, "fill", "N10E010.hgt", "out.tif", says=["out.tif", "exists"])
        with open(self.path("out.tif")) as file:
            self.assertEqual(file.read(), "mine")

    def test_existing_output_is_replaced_with_overwrite(self):
        self.holed()
        self.write("out.tif", "mine")
        self.succeeds("fill", "N10E010.hgt", "out.tif", "--overwrite")
        self.succeeds("info", "out.tif")

    def test_missing_folder_is_refused(self):
        self.holed()
        self.fails(2, "fill", "N10E010.hgt", "no/such/out.tif", says=["no/such"])

    def test_folder_below_a_file_is_refused(self):
        self.holed()
        self.fails(2, "curve", "N10E010.hgt", "N10E010.hgt/out", says=["N10E010.hgt"])
        self.fails(2, "curve", "N10E010.hgt", "N10E010.hgt", says=["not a folder"])
        self.assert_files("N10E010.hgt")

    def test_unknown_format_is_refused(self):
        self.holed()
        self.fails(2, "fill", "N10E010.hgt", "out.xyzzy", says=["out.xyzzy"])
        self.assert_files("N10E010.hgt")

    def test_full_disk_leaves_nothing(self):
        self.noisy()
        for out in ("out.tif", "out.hgt", "out.asc"):
            done = self.fails(2, "fill", "N10E010.hgt", out, preexec_fn=limit_file_size(20000),
                              says=[out])
            self.assertEqual(done.stderr.count(out), 1)  # its folder while writing is no news
            self.assert_files("N10E010.hgt")

    def test_full_disk_leaves_the_old_file(self):
        self.noisy()
        self.write("out.tif", "mine")
        self.fails(2, "fill", "N10E010.hgt", "out.tif", "--overwrite",
                   preexec_fn=limit_file_size(20000), says=["out.tif"])
        with open(self.path("out.tif")) as file:
            self.assertEqual(file.read(), "mine")
        self.assert_files("N10E010.hgt", "out.tif")

    def test_closed_stdout_is_an_error(self):
        for argument in ("methods", "--help"):
            with open("/dev/full", "w") as full:
                done = subprocess.run([DEM, argument], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 2)
            self.assert_one_error_line(done.stderr, ["No space left"])

    def noisy(self):
        """Heights that no compression makes small."""
        noise = random.Random(1)
        self.hgt(side=257, value=lambda c, r: VOID if c == 9 else noise.randrange(30000))


class BadUsage(CliTest):
    def test_no_argument_shows_the_help_as_usage(self):
        done = self.dem()
        self.assertEqual(done.returncode, 1)
        self.assertIn("Examples:", done.stderr)

    def test_unknown_verb_suggests_the_nearest(self):
        self.fails(1, "fil", "a", "b", says=["unknown verb fil", "fill"])

    def test_unknown_option_suggests_the_nearest(self):
        self.fails(1, "fill", "a", "b", "--metod", "mcmd", says=["--metod", "--method", "dem fill --help"])

    def test_unknown_option_before_the_verb_is_refused(self):
        self.fails(1, "--versoin", says=["--versoin", "--version"])

    def test_option_of_a_verb_before_the_verb_is_told_its_place(self):
        for option in ("--quiet", "-q"):
            self.fails(1, option, "fill", "a", "b", says=[option, "after the verb"])

    def test_height_range_of_one_number_is_refused(self):
        self.fails(1, "fill", "a", "b", "--height-range", "5", says=["height-range", "LOW,HIGH"])

    def test_missing_argument_is_named(self):
        self.fails(1, "fill", "a", says=["OUT", "dem fill --help"])

    def test_unexpected_argument_is_named(self):
        self.fails(1, "deterrace", "a", "b", "c", says=["c", "dem deterrace --help"])

    def test_number_that_is_none_is_refused(self):
        self.fails(1, "fill", "a", "b", "--threads", "many", says=["threads", "many"])

    def test_unknown_method_lists_those_there_are(self):
        self.holed()
        self.fails(1, "fill", "N10E010.hgt", "o.tif", "-m", "magic", says=["magic", "mcmd", "idw"])
        self.assert_files("N10E010.hgt")

    def test_unknown_preset_lists_those_there_are(self):
        self.fails(1, "fill", "a", "o.tif", "-m", "mcmd:magic", says=["magic", "mcmd:paper"])

    def test_unknown_setting_lists_those_there_are(self):
        self.fails(1, "fill", "a", "o.tif", "-m", "mcmd", "--set", "J=1", says=['"J"', "I_bu"])

    def test_setting_out_of_range_is_refused_before_any_file_is_read(self):
        self.fails(1, "fill", "nowhere.hgt", "o.tif", "-m", "mcmd", "--set", "I=1e9",
                   says=["I = 1e9", "must be"])

    def test_setting_without_value_is_refused(self):
        self.fails(1, "fill", "a", "o.tif", "--set", "I", says=["set = I", "KEY=VALUE"])

    def test_sigma_of_a_method_without_it_is_refused(self):
        self.fails(1, "fill", "a", "o.tif", "--sigma", "s.tif", "-m", "md", says=["sigma", "md"])

    def test_sample_needs_exactly_one_way(self):
        self.fails(1, "sample", "a", "b", says=["dem sample --help"])
        self.fails(1, "sample", "a", "b", "--every", "2", "--count", "9", says=["dem sample --help"])

    def test_number_of_samples_must_be_positive(self):
        for way in ("--count", "--every", "--tracks", "--contours"):
            done = self.fails(1, "sample", "a", "b", way, "0", says=[way, "0; must be", "above 0"])
            self.assertLess(len(done.stderr), 100)
        self.fails(1, "sample", "a", "b", "--count", "5", "--seed=-1", says=["seed", "-1; must be"])

    def test_share_without_percent_sign_is_refused(self):
        self.fails(1, "sample", "a", "b", "--keep", "3.4", says=["keep = 3.4", "3.4%"])
        self.fails(1, "sample", "a", "b", "--keep", "140%", says=["keep = 140%"])

    def test_count_beyond_the_known_cells_is_refused(self):
        self.hgt(side=5)
        self.fails(1, "sample", "N10E010.hgt", "b.tif", "--count", "26", says=["26", "25"])
        self.assert_files("N10E010.hgt")

    def test_expectation_that_is_none_is_refused(self):
        self.fails(1, "evaluate", "a", "b", "--expect", "rsme<3", says=["rsme<3", "rmse"])

    def test_rate_of_all_cells_is_refused(self):
        self.fails(1, "curve", "a", "out", "--rates", "100%", says=["100"])
        self.assert_files()


class OptionsFirst(CliTest):
    """Every option is checked before a file is opened: IN is missing, and the option is named."""

    WRITING = [("--type", "int12"), ("--format", "XYZZY"), ("--co", "NO_SUCH=1"), ("--co", "ZLEVEL"),
               ("--compress", "rar"), ("--out-nodata", "none")]
    READING = [("--band", "0"), ("--tile", "here"), ("--nodata", "none"), ("--height-range", "5,1"),
               ("--unknown-grey", "2")]
    ANY = [("--threads", "-1"), ("--progress", "dots"), ("--no-such-option", "")]
    BAD = {
        ("info", "IN"): [("--holes", "no/such/a.gpkg"), *READING],
        ("fill", "IN", "out.tif"): [
            ("--set", "I"), ("--set", "nothing=1"), ("--method", "magic"), ("--sigma", "no/such/a.tif"),
            ("--roughness", "much"), ("--realisation", "0"), ("--seed", "-1"), ("--source", "no/such/a.tif"),
            ("--report-holes", "no/such/a.json"), ("--report", "a.tif"), ("--memory", "much"), ("--task", "9/8"),
            ("--max-area-km2", "0"), ("--min-cells", "-1"), ("--where", "colour < 5"), *READING, *WRITING],
        ("grid", "IN", "out.tif"): [
            ("--set", "I"), ("--method", "magic"), ("--combine", "sum"), ("--passes", "-1"), ("--cell", "0"),
            ("--cell", "3ells"), ("--bounds", "1,2"), ("--crs", "EPSG:1"), ("--to-crs", "nowhere"), ("--class", "256"),
            ("--delimiter", "ab"), ("--reject-outliers", "0"), ("--sigma", "no/such/a.tif"), *WRITING],
        ("supersample", "IN", "out.tif", "--factor", "2"): [
            ("--preserve", "all"), ("--method", "magic"), ("--set", "I"), ("--seed", "x"), *READING, *WRITING],
        ("supersample", "IN", "out.tif"): [("--factor", "1")],
        ("deterrace", "IN", "out.tif"): [("--bound", "-1"), ("--passes", "x"), *READING, *WRITING],
        ("render", "IN", "out.png"): [("--style", "oil"), ("--palette", "pink"), ("--exaggeration", "x"), *READING],
        ("render", "IN", "out.png", "--style", "view"): [("--size", "5"), ("--camera", "1,2"), ("--target", "1,2,x")],
        ("check", "IN"): READING,
        ("sample", "IN", "out.tif"): [("--keep", "3.4"), ("--voids", "0%"), ("--count", "0"), ("--every", "x"),
                                      ("--max-error", "0")],
        ("sample", "IN", "out.tif", "--count", "5"): [("--seed", "-1"), ("--method", "magic"), *READING, *WRITING],
        ("evaluate", "IN", "IN"): [("--expect", "rsme<3"), ("--report", "a.tif"), *READING],
        ("curve", "IN", "out"): [("--rates", "50"), ("--methods", "magic"), ("--budget", "x"), ("--repeats", "0"),
                                 ("--seed", "x"), ("--report", "a.tif"), *READING],
        ("reproduce", "mount-washington", "out", "--tile", "IN"): [("--repeats", "0")],
        ("generate", "sketch", "IN", "out.tif"): [("--size", "0"), ("--cell", "0"), ("--cell", "1s"), ("--crs", "1"),
                                                  ("--origin", "5"), ("--seed", "x"), ("--set", "I"),
                                                  ("--median", "-1"), *WRITING],
        ("erode", "IN", "out.tif"): [("--set", "steps=x"), ("--every", "0"), ("--water", "no/such/a.tif"),
                                     *READING, *WRITING],
    }

    def test_a_bad_option_is_named_though_the_input_is_missing(self):
        for words, bad in self.BAD.items():
            for option, value in bad + self.ANY:
                given = f"{option}={value}" if value else option
                with self.subTest(verb=words[0], given=given):
                    done = self.dem(*words, given)
                    self.assertIn(done.returncode, (1, 2), done.stderr)
                    self.assert_one_error_line(done.stderr)
                    self.assertFalse(done.stderr.startswith("dem: IN:"), done.stderr)
                    named = [option.lstrip("-"), value.split("=")[0], value.split("/a.")[0]]
                    self.assertTrue(any(name and name in done.stderr for name in named), done.stderr)
        self.assert_files()

    def test_an_option_given_twice_is_refused(self):
        self.fails(1, "fill", "IN", "out.tif", "--sigma", "a.tif", "--sigma", "b.tif",
                   says=["--sigma", "more than once"])

    def test_an_option_is_no_value_of_another(self):
        self.fails(1, "fill", "IN", "out.tif", "--sigma", "--json", says=["--sigma needs a value", "--json"])


class Interruption(CliTest):
    def interrupted(self, number, *arguments):
        """Sends the signal once the work has begun; returns the exit code and the last line."""
        run = subprocess.Popen([DEM, *arguments, "--progress", "json"], cwd=self.dir, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertIn('"part"', run.stderr.readline())
        run.send_signal(number)
        out, err = run.communicate(timeout=60)
        self.assertEqual(out, "")
        self.assert_one_error_line(err.splitlines(keepends=True)[-1], ["interrupted"])
        return run.returncode

    def test_sigint_in_a_curve_is_exit_5_and_leaves_no_folder(self):
        self.hgt(side=257)
        code = self.interrupted(signal.SIGINT, "curve", "N10E010.hgt", "out", "--repeats", "1000")
        self.assertEqual(code, 5)
        self.assert_files("N10E010.hgt")

    def test_sigint_in_a_reproduction_is_exit_5_and_leaves_no_folder(self):
        self.hgt(side=257)
        code = self.interrupted(signal.SIGINT, "reproduce", "mount-washington", "out", "--tile",
                                "N10E010.hgt", "--repeats", "1000")
        self.assertEqual(code, 5)
        self.assert_files("N10E010.hgt")

    def test_sigterm_in_a_fill_is_exit_5_and_leaves_the_old_file(self):
        self.hgt(side=1201, value=lambda c, r: height(c, r) if (c * 31 + r * 17) % 97 == 0 else VOID)
        self.write("out.tif", "mine")
        code = self.interrupted(signal.SIGTERM, "fill", "N10E010.hgt", "out.tif", "-m", "idw",
                                "--overwrite")
        self.assertEqual(code, 5)
        with open(self.path("out.tif")) as file:
            self.assertEqual(file.read(), "mine")
        self.assert_files("N10E010.hgt", "out.tif")

    def test_closed_pipe_ends_quietly(self):
        run = subprocess.Popen([DEM, "methods"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        run.stdout.close()
        self.assertEqual(run.stderr.read(), b"")
        run.stderr.close()
        self.assertIn(run.wait(timeout=60), (0, -signal.SIGPIPE))


if __name__ == "__main__":
    main()
