"""What the verbs of the command line promise when all is well."""

import json
import math
import os
import re
import struct
import unittest

from support import VOID, CliTest, asc_text, height, main, raw_vrt_text, read_hgt

VERBS = ["info", "sample", "fill", "grid", "supersample", "deterrace", "check", "evaluate", "curve", "reproduce",
         "generate", "erode", "render", "methods"]


class Help(CliTest):
    def test_version_names_the_program_and_its_number(self):
        self.assertRegex(self.succeeds("--version").stdout, r"^dem \d+\.\d+\.\d+\n$")

    def test_lines_fit_in_100_columns(self):
        for arguments in [["--help"]] + [[verb, "--help"] for verb in VERBS]:
            for line in self.succeeds(*arguments).stdout.splitlines():
                self.assertLessEqual(len(line), 100, f"{arguments}: {line}")

    def test_each_verb_gives_two_to_four_examples_of_itself(self):
        for verb in VERBS:
            examples = re.findall(rf"^  dem {verb}\b", self.succeeds(verb, "--help").stdout, re.M)
            self.assertIn(len(examples), (2, 3, 4), verb)

    def test_each_verb_takes_the_shared_options(self):
        for verb in VERBS:
            text = self.succeeds(verb, "--help").stdout
            for option in ("--json", "--quiet", "--progress", "--threads", "--overwrite"):
                self.assertIn(option, text, verb)


class Info(CliTest):
    def test_tells_voids_range_and_registration(self):
        self.holed()
        facts = json.loads(self.succeeds("info", "N10E010.hgt", "--json").stdout)["files"][0]
        self.assertEqual((facts["cols"], facts["rows"]), (33, 33))
        self.assertEqual(facts["registration"], "node")
        self.assertTrue(facts["geographic"])
        self.assertEqual(facts["unknown_cells"], 12 + 6)
        self.assertEqual((facts["voids"], facts["largest_void_cells"]), (2, 12))
        self.assertEqual((facts["border_voids"], facts["border_void_cells"]), (1, 6))
        values = [v for v in read_hgt(self.path("N10E010.hgt")) if v != VOID]
        self.assertEqual((facts["low_m"], facts["high_m"]), (min(values), max(values)))

    def test_measures_cells_in_metres(self):
        self.write("a.asc", asc_text([[1, 2], [3, 4]]))
        facts = json.loads(self.succeeds("info", "a.asc", "--json").stdout)["files"][0]
        self.assertEqual(facts["cell_m"]["middle"], [10, 10])

    def test_prints_each_file_it_is_given(self):
        self.write("a.asc", asc_text([[1, 2], [3, 4]]))
        self.holed()
        text = self.succeeds("info", "a.asc", "N10E010.hgt").stdout
        self.assertIn("a.asc", text)
        self.assertIn("33 x 33", text)


class Sample(CliTest):
    def known(self, path):
        return sum(v != VOID for v in read_hgt(self.path(path)))

    def test_count_is_exact_and_kept_cells_are_unchanged(self):
        self.hgt()
        self.succeeds("sample", "N10E010.hgt", "N10E010.out.hgt", "--count", "123")
        before, after = read_hgt(self.path("N10E010.hgt")), read_hgt(self.path("N10E010.out.hgt"))
        self.assertEqual(self.known("N10E010.out.hgt"), 123)
        self.assertTrue(all(a in (b, VOID) for a, b in zip(after, before)))

    def test_percentages_are_of_the_known_cells(self):
        self.holed()
        known = 33 * 33 - 18
        for option in ("--keep", "--edges"):
            self.succeeds("sample", "N10E010.hgt", "N10E010.out.hgt", option, "10%", "--overwrite")
            self.assertEqual(self.known("N10E010.out.hgt"), round(known / 10))
        self.succeeds("sample", "N10E010.hgt", "N10E010.out.hgt", "--voids", "10%", "--overwrite")
        self.assertEqual(self.known("N10E010.out.hgt"), known - round(known / 10))

    def test_a_part_may_be_written_in_three_ways(self):
        self.hgt()
        for number, part in enumerate(["10%", "10 %", "0.1"]):
            self.succeeds("sample", "N10E010.hgt", f"{number}.asc", "--keep", part)
        self.assertEqual(self.read("0.asc"), self.read("1.asc"))
        self.assertEqual(self.read("0.asc"), self.read("2.asc"))

    def test_every_keeps_a_regular_lattice(self):
        self.hgt()
        self.succeeds("sample", "N10E010.hgt", "N10E010.out.hgt", "--every", "8")
        self.assertEqual(self.known("N10E010.out.hgt"), 25)

    def test_tracks_and_contours_keep_a_part(self):
        self.hgt()
        for option in (["--tracks", "3"], ["--contours", "20"]):
            self.succeeds("sample", "N10E010.hgt", "N10E010.out.hgt", *option, "--overwrite")
            self.assertTrue(0 < self.known("N10E010.out.hgt") < 33 * 33)

    def test_seed_chooses_the_cells(self):
        self.hgt()
        for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
            self.succeeds("sample", "N10E010.hgt", f"{name}.asc", "--count", "50", "--seed", seed)
        first, same, other = (self.read(f"{name}.asc") for name in "abc")
        self.assertEqual(first, same)
        self.assertNotEqual(first, other)


class Fill(CliTest):
    def test_fills_every_void_and_keeps_known_cells(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "N10E010.out.hgt")
        before, after = read_hgt(self.path("N10E010.hgt")), read_hgt(self.path("N10E010.out.hgt"))
        self.assertNotIn(VOID, after)
        self.assertTrue(all(b in (a, VOID) for a, b in zip(after, before)))

    def test_inner_only_leaves_voids_at_the_border_and_is_done(self):
        self.holed()
        done = self.succeeds("fill", "N10E010.hgt", "N10E010.out.hgt", "--inner-only", "--json")
        report = json.loads(done.stdout)
        self.assertEqual((report["filled"], report["left_at_border"], report["left"]), (12, 6, 0))
        self.assertEqual(read_hgt(self.path("N10E010.out.hgt")).count(VOID), 6)

    def test_all_known_is_a_copy(self):
        self.hgt()
        self.succeeds("fill", "N10E010.hgt", "N10E010.out.hgt")
        self.assertEqual(self.read("N10E010.hgt"), self.read("N10E010.out.hgt"))

    def test_one_cell_is_a_copy(self):
        self.write("one.asc", asc_text([[42]]))
        self.succeeds("fill", "one.asc", "out.tif")
        facts = json.loads(self.succeeds("info", "out.tif", "--json").stdout)["files"][0]
        self.assertEqual((facts["cols"], facts["rows"], facts["low_m"]), (1, 1, 42))

    def test_every_method_fills_with_any_number_of_threads_alike(self):
        self.holed()
        table = json.loads(self.succeeds("methods", "--json").stdout)["fill"]
        for name in [m["name"] for m in table]:
            for threads in "12":
                self.succeeds("fill", "N10E010.hgt", f"N10E010.{threads}.hgt", "-m", name,
                              "-j", threads, "--overwrite")
            self.assertEqual(self.read("N10E010.1.hgt"), self.read("N10E010.2.hgt"), name)

    def test_nan_and_infinity_are_voids(self):
        cells = [math.nan, 5, 5, 5, math.inf, 5, -math.inf, 5, 5]
        self.write("a.raw", struct.pack("<9f", *cells))
        self.write("a.vrt", raw_vrt_text("a.raw", size=3))
        report = json.loads(self.succeeds("fill", "a.vrt", "out.tif", "--json").stdout)
        self.assertEqual(report["filled"], 3)
        facts = json.loads(self.succeeds("info", "out.tif", "--json").stdout)["files"][0]
        self.assertEqual((facts["low_m"], facts["high_m"], facts["unknown_cells"]), (5, 5, 0))

    def test_nodata_given_by_hand_is_a_void(self):
        self.write("a.asc", asc_text([[0, 5, 5], [5, 5, 5]], nodata=None))
        report = json.loads(self.succeeds("fill", "a.asc", "o.tif", "--nodata", "0", "--json").stdout)
        self.assertEqual(report["filled"], 1)

    def test_type_and_format_are_as_asked(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "out.bin", "--format", "GTiff", "--type", "float32")
        facts = json.loads(self.succeeds("info", "out.bin", "--json").stdout)["files"][0]
        self.assertEqual((facts["format"], facts["type"]), ("GTiff", "float32"))

    def test_known_cells_written_in_another_type_are_not_called_unchanged(self):
        self.holed()
        self.assertIn("known cells unchanged", self.succeeds("fill", "N10E010.hgt", "a.tif").stderr)
        done = self.succeeds("fill", "N10E010.hgt", "b.tif", "--type", "float32")
        self.assertIn("known cells written as float32", done.stderr)

    def test_settings_reach_the_method(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "a.tif", "-m", "mcmd")
        self.succeeds("fill", "N10E010.hgt", "b.tif", "-m", "mcmd", "--set", "rs=5", "--set", "H=0.2")
        done = self.succeeds("evaluate", "a.tif", "b.tif", "--json")
        self.assertGreater(json.loads(done.stdout)["all"]["rmse_m"], 0)

    def test_sigma_is_zero_where_known_and_positive_elsewhere(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "out.tif", "--sigma", "sigma.tif")
        facts = json.loads(self.succeeds("info", "sigma.tif", "--json").stdout)["files"][0]
        self.assertEqual(facts["type"], "float32")
        self.assertEqual((facts["unknown_cells"], facts["low_m"]), (0, 0))
        self.assertGreater(facts["high_m"], 0)

    def test_realisations_differ_by_number_and_seed_only(self):
        self.holed()
        for name, options in {"a": ["1"], "b": ["1"], "c": ["2"], "d": ["1", "--seed", "9"]}.items():
            self.succeeds("fill", "N10E010.hgt", name + ".tif", "--type", "float32", "--realisation", *options)
        rmse = {name: json.loads(self.succeeds("evaluate", "a.tif", name + ".tif", "--json").stdout)["all"]["rmse_m"]
                for name in "bcd"}
        self.assertEqual(rmse["b"], 0)
        self.assertGreater(rmse["c"], 0)
        self.assertGreater(rmse["d"], 0)

    def test_quiet_says_nothing(self):
        self.holed()
        done = self.succeeds("fill", "N10E010.hgt", "out.tif", "-q")
        self.assertEqual((done.stdout, done.stderr), ("", ""))


    def test_several_files_are_tiles_of_one_dem(self):
        self.holed("N10E010.hgt", side=1201)
        self.hgt("N10E011.hgt", side=1201, value=lambda c, r: height(c + 1200, r))
        os.mkdir(self.path("tiles"))
        for name in ("N10E010.hgt", "N10E011.hgt"):
            self.write("tiles/" + name, self.read(name))
        self.succeeds("fill", "N10E010.hgt", "N10E011.hgt", "from_files/")
        self.succeeds("fill", "tiles", "from_folder/")
        self.succeeds("fill", "N10E010.hgt", "N10E011.hgt", "by_parts/", "--memory", "1G")
        for name in ("N10E010.hgt", "N10E011.hgt"):
            self.assertEqual(self.read("from_files/" + name), self.read("from_folder/" + name))
            self.assertEqual(self.read("by_parts/" + name), self.read("from_folder/" + name))

    def test_creation_options_reach_the_file(self):
        self.holed()
        sizes = []
        for name, options in {"a": ["--compress", "none"], "b": ["--compress", "zstd"],
                              "c": ["--co", "COMPRESS=NONE", "--co", "TILED=NO"]}.items():
            self.succeeds("fill", "N10E010.hgt", name + ".tif", *options)
            sizes.append(os.path.getsize(self.path(name + ".tif")))
        self.assertGreater(sizes[0], sizes[1])
        self.assertNotEqual(sizes[0], sizes[2])
        self.fails(2, "fill", "N10E010.hgt", "N10E010.out.hgt", "--co", "A=1", says=["A", "takes none"])


class Evaluate(CliTest):
    def test_scores_the_filled_cells_alone_with_known(self):
        self.hgt()
        self.succeeds("sample", "N10E010.hgt", "s.tif", "--count", "89")
        self.succeeds("fill", "s.tif", "f.tif")
        done = self.succeeds("evaluate", "N10E010.hgt", "f.tif", "--known", "s.tif", "--json")
        scores = json.loads(done.stdout)
        self.assertEqual(scores["all"]["cells"], 1089)
        self.assertEqual(scores["filled"]["cells"], 1000)
        squares = [scores[k]["rmse_m"] ** 2 * scores[k]["cells"] for k in ("all", "filled")]
        self.assertAlmostEqual(squares[0] / squares[1], 1, places=9)
        self.assertTrue(scores["spectrum"])

    def test_of_equal_files_is_zero(self):
        self.hgt()
        scores = json.loads(self.succeeds("evaluate", "N10E010.hgt", "N10E010.hgt", "--json").stdout)
        self.assertEqual((scores["all"]["rmse_m"], scores["all"]["max_m"]), (0, 0))

    def test_expectation_met_is_done_and_broken_is_exit_4(self):
        self.hgt()
        self.hgt("N10E010.out.hgt", value=lambda c, r: height(c, r) + 3)
        files = ["evaluate", "N10E010.hgt", "N10E010.out.hgt"]
        self.succeeds(*files, "--expect", "rmse<=3", "--expect", "bias>2.9")
        done = self.dem(*files, "--expect", "rmse<3")
        self.assertEqual(done.returncode, 4)
        self.assert_one_error_line(done.stderr, ["rmse<3", "found 3"])


class Curve(CliTest):
    def test_writes_table_json_and_picture(self):
        self.hgt()
        done = self.succeeds("curve", "N10E010.hgt", "out", "-m", "mcmd,md", "-r", "50%,5%",
                             "--repeats", "1", "--json")
        scores = json.loads(done.stdout)["scores"]
        self.assertEqual([(s["method"], s["kept_percent"]) for s in scores],
                         [("mcmd", 50), ("md", 50), ("mcmd", 5), ("md", 5)])
        self.assertEqual(sorted(os.listdir(self.path("out"))),
                         ["curves.csv", "curves.json", "curves.svg"])
        with open(self.path("out/curves.csv")) as file:
            self.assertEqual(len(file.readlines()), 5)

    def test_progress_json_is_one_object_a_line(self):
        self.hgt(side=257)
        done = self.succeeds("curve", "N10E010.hgt", "out", "-m", "idw", "-r", "1%,2%,5%", "-q",
                             "--progress", "json")
        lines = [json.loads(line) for line in done.stderr.splitlines()]
        self.assertTrue(all(0 <= line["part"] <= 1 and "what" in line for line in lines))


class Reproduce(CliTest):
    def test_mount_washington_runs_on_any_tile(self):
        self.hgt(side=65)
        done = self.succeeds("reproduce", "mount-washington", "out", "--tile", "N10E010.hgt",
                             "--repeats", "1", "--json")
        numbers = {n["what"]: n for n in json.loads(done.stdout)["numbers"]}
        self.assertEqual(numbers["mcmd:paper: RMSE over the removed cells"]["paper"], 5.8)
        self.assertIn("Smaller than the paper's", done.stdout)

    def test_n36e008_scores_real_voids_when_a_filled_edition_is_there(self):
        self.holed("N10E010.void.hgt", side=65)
        self.hgt("N10E010.filled.hgt", side=65)
        done = self.succeeds("reproduce", "n36e008", "out", "--data", self.dir, "--tile",
                             self.path("N10E010.void.hgt"), "--json")
        names = [n["what"] for n in json.loads(done.stdout)["numbers"]]
        self.assertIn("mcmd: RMSE in the real voids", names)

    def test_figures_makes_every_picture_it_names(self):
        done = self.succeeds("reproduce", "figures", "out", "--json")
        pictures = json.loads(done.stdout)["pictures"]
        self.assertEqual(len(pictures), 6)
        for picture in pictures:
            self.assertGreater(os.path.getsize(self.path(picture)), 1000)


class Methods(CliTest):
    def test_json_is_an_object_of_fill_methods_and_generators(self):
        table = json.loads(self.succeeds("methods", "--json").stdout)
        self.assertEqual(sorted(table), ["erosion", "fill", "generators", "options", "styles", "verbs"])
        for method in table["fill"]:
            for key in ("name", "summary", "citation", "fields"):
                self.assertIn(key, method)

    def test_name_shows_one_method(self):
        text = self.succeeds("methods", "mcmd").stdout
        self.assertIn("weight_exponent", text)
        self.assertNotIn("pushpull", text)


if __name__ == "__main__":
    main()
