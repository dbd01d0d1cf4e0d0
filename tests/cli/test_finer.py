"""What `dem supersample`, `dem deterrace` and the greedy ways of `dem sample` promise."""

import json
import math
import os

from support import CliTest, asc_text, main


def ground(c, r):
    return 100 + 20 * math.sin(c / 6) * math.cos(r / 5) + c / 4


class Finer(CliTest):
    def raster(self, name="in.asc", cols=30, rows=24, value=ground):
        return self.write(name, asc_text([[value(c, r) for c in range(cols)] for r in range(rows)]))

    def heights(self, name):
        rows = [line.split() for line in self.read(name).decode().splitlines() if line[0] not in "ncxydN"]
        return [[float(v) for v in row] for row in rows]

    def report(self, *arguments):
        return json.loads(self.succeeds(*arguments, "--json").stdout)

    def test_supersample_keeps_the_ground_it_covers(self):
        self.raster()
        facts = self.report("supersample", "in.asc", "out.asc", "--factor", "3")
        self.assertEqual((facts["cols"], facts["rows"]), (90, 72))
        self.assertEqual(facts["miss_max_m"], 0)
        coarse, fine = self.heights("in.asc"), self.heights("out.asc")
        for r in range(24):
            for c in range(30):
                self.assertAlmostEqual(fine[3 * r + 1][3 * c + 1], coarse[r][c], delta=1e-3)

    def test_supersample_keeps_block_means(self):
        self.raster()
        facts = self.report("supersample", "in.asc", "out.asc", "--factor", "2.5", "--preserve", "block-mean")
        self.assertLess(facts["miss_max_m"], 2e-3)

    def test_roughness_is_another_surface_through_the_same_heights(self):
        self.raster()
        self.report("supersample", "in.asc", "a.asc", "--factor", "3")
        facts = self.report("supersample", "in.asc", "b.asc", "--factor", "3", "--roughness")
        self.assertEqual(facts["miss_max_m"], 0)
        self.assertNotEqual(self.heights("a.asc"), self.heights("b.asc"))

    def test_deterrace_stays_within_its_bound(self):
        self.raster(value=lambda c, r: round(ground(c, r)))
        facts = self.report("deterrace", "in.asc", "out.asc")
        self.assertTrue(0 < facts["moved_max_m"] <= 0.5)

    def test_greedy_samples_by_count_and_by_error(self):
        self.raster()
        self.assertEqual(self.report("sample", "in.asc", "a.asc", "--greedy", "77")["known_after"], 77)
        self.report("sample", "in.asc", "b.asc", "--max-error", "1.5", "-m", "mcmd")
        self.report("fill", "b.asc", "filled.asc", "-m", "mcmd")
        errors = self.report("evaluate", "in.asc", "filled.asc")
        self.assertIn("max_m", json.dumps(errors))
        for want, got in zip(self.heights("in.asc"), self.heights("filled.asc")):
            for a, b in zip(want, got):
                self.assertLess(abs(a - b), 1.501)

    def test_budget_draws_what_each_way_of_sampling_needs(self):
        self.raster()
        facts = self.report("curve", "in.asc", "results", "--budget", "2", "--methods", "mcmd", "--rates", "2%,5%,20%")
        self.assertEqual({n["strategy"] for n in facts["needed"]}, {"random", "regular", "silhouette", "greedy"})
        self.assertEqual(sorted(os.listdir(self.path("results"))), ["budget.csv", "budget.json", "budget.svg"])

    def test_bad_values_are_one_line(self):
        self.raster()
        self.fails(1, "supersample", "in.asc", "out.asc", "--factor", "1",
                   says=["factor = 1; must be a number above 1"])
        self.fails(1, "supersample", "in.asc", "out.asc", says=["--factor"])
        self.fails(1, "supersample", "in.asc", "out.asc", "-f", "2", "-m", "mcmd", "--roughness", says=["--roughness"])
        self.fails(1, "deterrace", "in.asc", "out.asc", "--bound=-1", says=["bound = -1"])
        self.fails(1, "sample", "in.asc", "out.asc", "--greedy", "3", says=["greedy = 3; must be in [4, 720]"])
        self.fails(1, "curve", "in.asc", "results", "--budget", "0", says=["budget = 0"])


if __name__ == "__main__":
    main()
