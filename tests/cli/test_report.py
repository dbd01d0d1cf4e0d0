"""The pages of --report: what they hold, and how they behave in a browser."""

import json
import os
import re
import unittest

import browser
from support import CliTest, asc_text, height, hgt_bytes, limit_file_size, main, slow

SIDE = 65
TRUTH = "N10E010.whole.hgt"
WIDTHS = (1600, 400)


class ReportTest(CliTest):
    def tiles(self):
        """A whole hill, and the same with 60 small holes and one at the border."""

        def value(c, r):
            hole = c % 8 in (3, 4) and r % 8 == 3 and r < 60 or c < 2 and r < 2
            return -32768 if hole else height(c, r)

        self.hgt(TRUTH, SIDE)
        self.write("N10E010.hgt", hgt_bytes(SIDE, value))

    def filled(self, *options):
        self.tiles()
        return self.succeeds("fill", "N10E010.hgt", "filled.tif", "--report", "fill.html", *options)

    def data(self, name):
        text = self.read(name).decode()
        return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1))

    def section(self, data, title):
        return next(s for s in data["sections"] if s["title"] == title)


class WhatItHolds(ReportTest):
    def test_a_fill_shows_pictures_holes_and_how_it_was_made(self):
        self.filled("--sigma", "sigma.tif")
        data = self.data("fill.html")
        holes = self.section(data, "Holes")
        self.assertEqual(len(holes["rows"]), 12)
        self.assertRegex(holes["note"], r"53 smaller ones, \d+ cells together, are not shown")
        self.assertEqual(sum(self.section(data, "Holes by size")["counts"]), 65)
        self.assertTrue(self.section(data, "Before and after")["before"]["src"].startswith("data:image/"))
        self.assertEqual(sum(self.section(data, "Filled cells by standard deviation")["counts"]),
                         int(dict(data["figures"])["cells filled"]))
        self.assertEqual(data["command"], "dem fill N10E010.hgt filled.tif --report fill.html --sigma sigma.tif")
        self.assertIn(["input", "N10E010.hgt"], data["making"])
        self.assertEqual([step for step, _ in data["timings"]],
                         ["reading", "finding holes and filling", "drawing", "writing", "together"])

    def test_part_by_part_it_is_the_same(self):
        self.filled("--inner-only")
        self.succeeds("fill", "N10E010.hgt", "parts.tif", "--inner-only", "--memory", "600M", "--report", "parts.html")
        whole, parts = self.data("fill.html"), self.data("parts.html")
        for title in ("Before and after", "Where heights come from", "Holes by size"):
            self.assertEqual(self.section(whole, title), self.section(parts, title))
        pictures = [row[:6] for row in self.section(whole, "Holes")["rows"]]
        self.assertEqual(pictures, [row[:6] for row in self.section(parts, "Holes")["rows"]])

    def test_errors_are_counted_in_every_chart(self):
        self.filled("--sigma", "sigma.tif")
        done = self.succeeds("evaluate", TRUTH, "filled.tif", "--known", "N10E010.hgt", "--sigma", "sigma.tif",
                             "--report", "errors.html", "--json")
        found, data = json.loads(done.stdout), self.data("errors.html")
        cells = found["filled"]["cells"]
        self.assertEqual(sum(self.section(data, "Error by distance to data")["counts"]), cells)
        inner = sum(self.section(data, "Error by slope")["counts"])
        self.assertTrue(cells - 4 <= inner < cells)  # four holes' cells lie on the rim, where no slope is
        self.assertLessEqual(sum(self.section(data, "Errors")["counts"]), cells)
        self.assertEqual(dict(data["figures"])["RMSE"], f"{found['filled']['rmse_m']:.2f} m")
        self.assertEqual(found["calibration"]["cells"], cells)
        self.assertIn("68.3", self.section(data, "Calibration of sigma")["note"])
        self.assertEqual(len(self.section(data, "Power spectrum")["series"]), 2)

    def test_a_curve_shows_each_method_at_each_rate(self):
        self.hgt(TRUTH, SIDE)
        self.succeeds("curve", TRUTH, "curves", "--methods", "mcmd,nearest", "--rates", "50%,10%",
                      "--repeats", "1", "--report", "curve.html")
        data = self.data("curve.html")
        self.assertEqual([s["name"] for s in self.section(data, "Error")["series"]], ["mcmd", "nearest"])
        self.assertEqual(len(self.section(data, "RMSE over the removed cells, m")["rows"]), 2)
        self.succeeds("curve", TRUTH, "budget", "--budget", "5", "--rates", "10%,20%", "--methods", "mcmd",
                      "--report", "budget.html")
        self.assertEqual(len(self.section(self.data("budget.html"), "Error")["series"]), 4)

    def test_a_name_is_text_not_markup(self):
        name = "</script><b>&'.asc"
        os.mkdir(self.path(os.path.dirname(name)))
        self.write(name, asc_text([[1, 2, 3], [4, -9999, 6], [7, 8, 9]]))
        self.succeeds("fill", name, "filled.tif", "--report", "fill.html")
        self.assertEqual(self.read("fill.html").count(b"</script>"), 3)  # data, charts, page
        self.assertIn("dem fill '</script><b>&'\\''.asc' filled.tif", self.data("fill.html")["command"])

    def test_nothing_to_fill_and_one_cell_are_no_trouble(self):
        self.hgt("N10E010.hgt")
        self.succeeds("fill", "N10E010.hgt", "copy.tif", "--report", "copy.html")
        self.assertIn("All cells were known", self.data("copy.html")["lead"])
        self.write("one.asc", asc_text([[5]]))
        self.succeeds("fill", "one.asc", "one.tif", "--report", "one.html")
        self.succeeds("evaluate", "one.asc", "one.tif", "--report", "same.html")
        titles = [section["title"] for section in self.data("same.html")["sections"]]
        self.assertEqual(titles, ["Truth and reconstruction", "Error", "Errors"])  # no slope, no wave
        self.write("flat.asc", asc_text([[5] * 20] * 20))
        self.succeeds("evaluate", "flat.asc", "flat.asc", "--report", "flat.html")
        self.assertNotIn("Power spectrum", [section["title"] for section in self.data("flat.html")["sections"]])


class Refusals(ReportTest):
    def test_a_bad_path_is_refused_before_any_work(self):
        self.tiles()
        os.mkdir(self.path("folder"))
        self.write("there.html", "mine")
        verbs = (("fill", "N10E010.hgt", "out.tif"), ("evaluate", TRUTH, TRUTH),
                 ("curve", TRUTH, "curves"))
        for verb in verbs:
            for path, code, says in (("folder", 2, "folder: is a folder"), ("none/a.html", 2, "none does not exist"),
                                     ("there.html", 2, "overwriting it was not asked for (--overwrite)"),
                                     ("a.tif", 1, "report = a.tif; must be a file name in .html")):
                self.fails(code, *verb, "--report", path, says=[says])
        self.assert_files("N10E010.hgt", TRUTH, "folder", "there.html")

    def test_a_folder_that_cannot_be_written_is_refused(self):
        self.tiles()
        self.fails(2, "fill", "N10E010.hgt", "out.tif", "--report", "/proc/a.html", says=["/proc cannot be written"])
        self.assert_files("N10E010.hgt", TRUTH)

    def test_a_full_disk_leaves_no_half_of_it(self):
        self.tiles()
        self.fails(2, "fill", "N10E010.hgt", "out.tif", "--report", "a.html", "--quiet",
                   preexec_fn=limit_file_size(100_000), says=["a.html: cannot be written"])
        self.assert_files("N10E010.hgt", TRUTH, "out.tif")

    def test_sigma_must_fit_and_say_something(self):
        self.tiles()
        self.write("zero.asc", asc_text([[0] * SIDE] * SIDE))
        self.write("small.asc", asc_text([[1, 2]]))
        self.fails(2, "evaluate", TRUTH, TRUTH, "--sigma", "small.asc", says=["is 2 x 1 cells"])
        self.fails(2, "evaluate", TRUTH, TRUTH, "--sigma", "zero.asc", says=["zero.asc", "sigma is above 0 in no cell"])


@slow
@unittest.skipUnless(browser.executable(), "no browser: install the package chromium")
class InABrowser(ReportTest):
    def setUp(self):
        super().setUp()
        self.page = browser.Browser()
        self.addCleanup(self.page.close)

    def open(self, name, width):
        self.page.open(self.path(name), width)
        self.assertEqual(self.page.complaints(), [])
        self.assertEqual(self.page.value("document.documentElement.scrollWidth"), width, "the page scrolls sideways")

    def test_pages_open_without_a_complaint_at_any_width(self):
        self.filled("--sigma", "sigma.tif")
        self.succeeds("evaluate", TRUTH, "filled.tif", "--known", "N10E010.hgt", "--sigma", "sigma.tif",
                      "--report", "errors.html")
        self.succeeds("curve", TRUTH, "curves", "--methods", "mcmd,nearest", "--rates", "50%,10%",
                      "--repeats", "1", "--report", "curve.html")
        for name, charts in (("fill.html", 4), ("errors.html", 7), ("curve.html", 2)):
            for width in WIDTHS:
                with self.subTest(page=name, width=width):
                    self.open(name, width)
                    drawn = "[...document.querySelectorAll('canvas')].filter(c => c.getContext('2d')" \
                            ".getImageData(0, 0, c.width, c.height).data.some(v => v)).length"
                    self.assertEqual(self.page.value(drawn), charts)
                    unnamed = "document.querySelectorAll('img:not([alt]), img[alt=\"\"], canvas:not([aria-label])')" \
                              ".length"
                    self.assertEqual(self.page.value(unnamed), 0)
                    whole = "[...document.images].every(i => i.complete && i.naturalWidth > 0)"
                    self.assertTrue(self.page.value(whole))
                    shifts = ("new Promise(done => new PerformanceObserver(list => done(list.getEntries().length))"
                              ".observe({type: 'layout-shift', buffered: true}) ?? setTimeout(() => done(0), 300))")
                    self.assertEqual(self.page.value(shifts), 0, "the layout shifts")

    def test_the_swipe_moves_by_keys_and_by_mouse(self):
        self.filled()
        self.open("fill.html", 1600)
        at = "document.querySelector('.frame').style.getPropertyValue('--at')"
        shown = "getComputedStyle(document.querySelector('.after')).clipPath"
        self.assertEqual(self.page.value(at), "50%")
        self.page.value("document.querySelector('.swipe input').focus()")
        for _ in range(3):
            self.page.press("ArrowRight")
        self.assertEqual(self.page.value(at), "53%")
        self.assertEqual(self.page.value(shown), "inset(0px 0px 0px 53%)")
        self.assertEqual(self.page.value("document.querySelector('.swipe input').ariaValueText"), "53 % before")

        box = "(b => [b.x, b.y, b.width, b.height])(document.querySelector('.frame').getBoundingClientRect())"
        x, y, width, high = self.page.value(box)
        self.page.drag((x + 0.53 * width, y + high / 2), (x + 0.2 * width, y + high / 2))
        self.assertEqual(self.page.value(at), "20%")


if __name__ == "__main__":
    main()
