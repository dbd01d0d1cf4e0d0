"""Filling hole by hole: choice of holes, what is reported, and rasters larger than memory."""

import json
import os
import random
import signal
import struct
import subprocess
import time
import unittest

from support import (DEM, VOID, CliTest, asc_text, height, hgt_bytes, limit_file_size, limit_memory, main, read_hgt,
                     slow)

KILLS = int(os.environ.get("DEM_KILLS", "2"))


class HoleTest(CliTest):
    def json(self, *arguments, **options):
        return json.loads(self.succeeds(*arguments, "--json", **options).stdout)

    def pitted(self, name="a.tif", side=300, share=0.02, type_="int16"):
        """A GeoTIFF with holes of many sizes."""
        dice = random.Random(3)
        void = set()
        while len(void) < share * side * side:
            c, r, n = dice.randrange(side), dice.randrange(side), dice.choice((1, 1, 2, 3, 9, 30))
            void |= {(x, y) for x in range(c, min(c + n, side)) for y in range(r, min(r + n, side))}
        self.hgt("N10E010.hgt", side, lambda c, r: VOID if (c, r) in void else height(c, r))
        self.succeeds("fill", "N10E010.hgt", name, "--where", "cells < 0", "--type", type_,
                      "--overwrite")
        os.remove(self.path("N10E010.hgt"))
        return name

    def cells(self, name):
        """The heights of a file, as float bytes."""
        self.succeeds("fill", name, "cells.img", "--where", "cells < 0", "--format", "ENVI",
                      "--type", "float32", "--overwrite")
        return self.read("cells.img")


class Choice(HoleTest):
    def test_each_option_leaves_the_others_and_is_done(self):
        self.holed()  # one void of 12 cells inside, one of 6 at the border
        for options, filled in ((["--inner-only"], 12), (["--min-cells", "7"], 12),
                                (["--where", "at_border"], 6), (["--where", "cells = 12 or row < 1"], 18),
                                (["--max-area-km2", "100"], 6), (["--max-distance-m", "1"], 0)):
            report = self.json("fill", "N10E010.hgt", "o.tif", "--overwrite", *options)
            self.assertEqual(report["filled"], filled, options)
            self.assertEqual(report["left"], 0, options)
            self.assertEqual(report["left_at_border"] + report["left_by_choice"], 18 - filled)

    def test_the_report_names_the_option_that_left_cells(self):
        self.holed()
        done = self.succeeds("fill", "N10E010.hgt", "o.tif", "--min-cells", "7")
        self.assertIn("6 left in 1 void by --min-cells", done.stderr)

    def test_region_takes_holes_in_its_polygons(self):
        self.holed()
        around = [[10.2, 10.0], [11, 10.0], [11, 10.6], [10.2, 10.6], [10.2, 10.0]]
        self.write("r.geojson", json.dumps({"type": "Polygon", "coordinates": [around]}))
        report = self.json("fill", "N10E010.hgt", "o.tif", "--region", "r.geojson")
        self.assertEqual((report["filled"], report["left_by_choice"]), (12, 6))

    def test_region_without_polygon_or_coordinate_system_is_refused(self):
        self.holed()
        self.write("r.geojson", json.dumps({"type": "Point", "coordinates": [10, 10]}))
        self.fails(2, "fill", "N10E010.hgt", "o.tif", "--region", "r.geojson", says=["no polygon"])
        self.write("p.csv", 'WKT\n"POLYGON((10 10,11 10,11 11,10 10))"\n')
        self.write("r.vrt", '<OGRVRTDataSource><OGRVRTLayer name="p"><SrcDataSource relativeToVRT="1">p.csv'
                            '</SrcDataSource><GeometryType>wkbPolygon</GeometryType><LayerSRS>NULL</LayerSRS>'
                            '<GeometryField encoding="WKT" field="WKT"/></OGRVRTLayer></OGRVRTDataSource>')
        self.fails(2, "fill", "N10E010.hgt", "o.tif", "--region", "r.vrt", says=["coordinate system"])
        self.fails(2, "fill", "N10E010.hgt", "o.tif", "--region", "none.gpkg", says=["none.gpkg"])

    def test_bad_condition_is_refused_before_any_file_is_read(self):
        self.fails(1, "fill", "nowhere.hgt", "o.tif", "--where", "area < 5", says=["area < 5", "area_km2"])
        self.fails(1, "fill", "nowhere.hgt", "o.tif", "--where", "cells < 5)", says=["operator"])
        self.fails(1, "fill", "a", "o.tif", "--max-area-km2", "0", says=["max-area-km2", "above 0"])


class Report(HoleTest):
    def test_holes_are_written_as_polygons_with_their_facts(self):
        self.holed()
        self.succeeds("info", "N10E010.hgt", "--holes", "h.geojson")
        features = json.loads(self.read("h.geojson"))["features"]
        facts = [f["properties"] for f in features]
        self.assertEqual([f["cells"] for f in facts], [6, 12])
        self.assertEqual([f["at_border"] for f in facts], [1, 0])
        square = 4 / 32 * 3 / 32  # degrees: cells are nodes 1/32 apart
        ring = features[1]["geometry"]["coordinates"][0][0]
        area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:])) / 2
        self.assertAlmostEqual(abs(area), square, places=9)
        self.assertGreater(facts[1]["rim_relief_m"], 0)

    def test_table_has_a_row_for_each_hole(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "o.tif", "--report-holes", "t.json", "--inner-only")
        rows = json.loads(self.read("t.json"))["holes"]
        self.assertEqual([r.get("left_by") for r in rows], ["inner_only", None])
        self.assertEqual(rows[1]["filled"], 12)
        self.assertGreater(rows[1]["rim_error_m"], 0)

    def test_source_tells_where_each_cell_comes_from(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "o.tif", "--source", "s.tif", "--inner-only")
        cells = self.cells("s.tif")
        kinds = memoryview(cells).cast("f").tolist()
        self.assertEqual([kinds.count(k) for k in (0, 1, 2, 3, 4)], [33 * 33 - 18, 12, 0, 0, 6])

    def test_flat_rim_is_filled_flat_and_told_as_water(self):
        self.hgt(value=lambda c, r: VOID if 10 <= c < 14 and 20 <= r < 23 else
                 7 if 8 <= c < 16 and 18 <= r < 25 else height(c, r))
        report = self.json("fill", "N10E010.hgt", "N10E010.o.hgt")
        self.assertEqual(report["water"], 12)
        self.assertEqual(read_hgt(self.path("N10E010.o.hgt"))[21 * 33 + 12], 7)

    def test_output_says_how_it_was_made(self):
        self.holed()
        self.succeeds("fill", "N10E010.hgt", "o.tif", "-m", "mcmd")
        for words in (b"dem fill N10E010.hgt o.tif -m mcmd", b"DEM_KNOWN_CHECKSUM"):
            self.assertIn(words, self.read("o.tif"))


class Layers(HoleTest):
    """A hole in a bumpy field that only another DEM knows, 30 m off; and a lake."""

    def bump(self, c, r):
        return height(c, r) + (90 if 12 <= c < 18 and 12 <= r < 18 else 0)

    def fields(self):
        self.hgt(value=lambda c, r: VOID if 10 <= c < 20 and 10 <= r < 20 else self.bump(c, r))
        self.hgt("N10E010.aux.hgt", value=lambda c, r: self.bump(c, r) - 30)

    def test_aux_brings_what_it_knows_without_its_offset(self):
        self.fields()
        for parts in ([], ["--memory", "300M"]):
            if parts:
                self.succeeds("fill", "N10E010.hgt", "a.tif", "--where", "cells < 0")
            done = self.dem("fill", "a.tif" if parts else "N10E010.hgt", "N10E010.o.hgt" if not parts else "o.tif",
                            "--aux", "N10E010.aux.hgt", "--json", "--source", "s.tif", "--overwrite", *parts)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("30.0 m below", done.stderr)
            report = json.loads(done.stdout)
            self.assertEqual(report["over_aux"], 100)
            self.assertAlmostEqual(report["aux"][0]["offset_m"], 30, places=3)
        got = read_hgt(self.path("N10E010.o.hgt"))
        worst = max(abs(got[r * 33 + c] - self.bump(c, r)) for c in range(33) for r in range(33))
        self.assertLessEqual(worst, 1)
        values = memoryview(self.cells("o.tif")).cast("f").tolist()
        self.assertEqual(values, [float(v) for v in got])

    def test_aux_in_another_grid_is_reprojected(self):
        self.fields()
        self.hgt("N10E010.fine.hgt", side=97, value=lambda c, r: self.bump(c / 3, r / 3) - 30)
        self.succeeds("fill", "N10E010.hgt", "N10E010.o.hgt", "--aux", "N10E010.fine.hgt")
        got = read_hgt(self.path("N10E010.o.hgt"))
        self.assertLessEqual(abs(got[15 * 33 + 15] - self.bump(15, 15)), 6)

    def test_aux_elsewhere_is_told_and_the_method_fills(self):
        self.fields()
        self.hgt("N50E050.hgt")
        done = self.succeeds("fill", "N10E010.hgt", "o.tif", "--aux", "N50E050.hgt", "--json")
        self.assertIn("does not cover", done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual((report["filled"], report["over_aux"]), (100, 0))

    def test_aux_without_coordinates_or_file_is_refused(self):
        self.fields()
        self.write("a.asc", asc_text([[1, 2], [3, 4]]))
        self.fails(2, "fill", "N10E010.hgt", "o.tif", "--aux", "a.asc", says=["a.asc", "coordinate system"])
        self.fails(2, "fill", "N10E010.hgt", "o.tif", "--aux", "none.tif", says=["none.tif"])

    def test_water_lies_flat(self):
        self.fields()
        lake = [[10.35, 10.3], [10.5, 10.3], [10.5, 10.6], [10.35, 10.6], [10.35, 10.3]]
        self.write("w.geojson", json.dumps({"type": "Polygon", "coordinates": [lake]}))
        report = self.json("fill", "N10E010.hgt", "N10E010.o.hgt", "--water", "w.geojson")
        got = read_hgt(self.path("N10E010.o.hgt"))
        sheet = {got[r * 33 + c] for c in range(12, 16) for r in range(14, 19)}
        self.assertEqual(len(sheet), 1)
        self.assertGreater(report["water"], 20)
        self.assertEqual(report["filled"], 100)


class Check(HoleTest):
    def tiles(self, wrong=()):
        os.makedirs(self.path("tiles"), exist_ok=True)
        for lon in (10, 11):
            self.hgt(f"tiles/N10E0{lon}.hgt", 33,
                     lambda c, r, o=32 * (lon - 10): height(c + o, r) + (7 if (lon, c, r) in wrong else 0))

    def test_tiles_with_equal_edges_pass(self):
        self.tiles()
        report = self.json("check", "tiles")
        self.assertEqual((report["tiles"], len(report["edges"]), report["bad_edges"]), (2, 1, 0))

    def test_edges_that_differ_are_listed(self):
        self.tiles(wrong={(11, 0, 5), (11, 9, 9)})
        done = self.dem("check", "tiles")
        self.assertEqual(done.returncode, 4)
        self.assertIn("N10E010.hgt and N10E011.hgt to its east: 1 of 33 shared cells differ, by up to 7 m",
                      done.stdout)

    def test_folder_without_tiles_is_refused(self):
        self.fails(2, "check", ".", says=["no .hgt"])
        self.fails(2, "check", "nowhere", says=["nowhere"])


class Tiles(HoleTest):
    memory = ["--memory", "400M"]

    def tiles(self):
        """Two tiles of 1201 x 1201, and a hole across the edge that they share."""
        os.makedirs(self.path("tiles"))
        line = [height(c, 0) for c in range(2401)]
        for tile in range(2):
            rows = []
            for r in range(1201):
                row = [v + r // 3 for v in line[1200 * tile:1200 * tile + 1201]]
                if 5 <= r < 12:
                    for c in range(1196, 1205):
                        if 0 <= c - 1200 * tile < 1201:
                            row[c - 1200 * tile] = VOID
                rows.append(struct.pack(">1201h", *row))
            self.write(f"tiles/N10E01{tile}.hgt", b"".join(rows))

    def test_a_folder_of_hgt_is_one_raster_and_becomes_such_a_folder(self):
        self.tiles()
        report = self.json("fill", "tiles", "out/", *self.memory)
        self.assertEqual((report["voids"], report["filled"], report["left"]), (1, 63, 0))
        self.assertEqual(self.json("check", "out")["bad_edges"], 0)
        for tile in range(2):
            before, after = (read_hgt(self.path(f"{d}/N10E01{tile}.hgt")) for d in ("tiles", "out"))
            self.assertNotIn(VOID, after)
            changed = {i for i in range(1201 * 1201) if before[i] != after[i]}
            self.assertEqual(changed, {i for i in range(1201 * 1201) if before[i] == VOID})
        self.json("fill", "tiles", "whole/")
        self.assertEqual(self.read("out/N10E011.hgt"), self.read("whole/N10E011.hgt"))
        self.fails(2, "fill", "tiles", "out/", says=["out/", "N10E010.hgt", "--overwrite"])
        self.succeeds("fill", "tiles", "out/", "--overwrite", "--resume", "-m", "mcmd")
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["N10E010.hgt", "N10E011.hgt"])
        self.assertFalse([n for n in os.listdir(self.dir) if n.startswith(".")])

    def test_a_tile_cut_short_is_named(self):
        self.tiles()
        os.truncate(self.path("tiles/N10E011.hgt"), 1000)
        self.fails(2, "fill", "tiles", "out/", says=["tiles", "N10E011.hgt"])
        self.assertFalse(os.path.exists(self.path("out")))

    def test_hgt_of_any_size_is_filled_part_by_part_too(self):
        self.hgt("N10E010.hgt", 65, lambda c, r: VOID if 20 < c < 30 and 20 < r < 40 else height(c, r))
        self.succeeds("fill", "N10E010.hgt", "w.hgt")
        for options in (self.memory, ["--resume"]):
            self.succeeds("fill", "N10E010.hgt", "o.hgt", "--overwrite", *options)
            self.assertEqual(self.read("o.hgt"), self.read("w.hgt"))

    def test_folder_is_for_hgt_and_for_whole_tiles(self):
        self.pitted()
        self.fails(2, "fill", "a.tif", "out/", "--format", "GTiff", says=["out/", ".vrt"])
        self.succeeds("generate", "noise", "n.tif", "--size", "40", "--cell", "30")
        for options in ([], self.memory):
            self.fails(2, "fill", "n.tif", "out/", *options, says=["out/", "one-degree tiles"])
        os.mkdir(self.path("out"))
        self.fails(2, "fill", "a.tif", "out", says=["out", "is a folder", "/"])

    def test_vrt_of_tiles_holds_the_same_cells_as_one_file(self):
        self.succeeds("generate", "noise", "n.tif", "--size", "5000x40", "--cell", "30")
        self.succeeds("sample", "n.tif", "a.tif", "--keep", "80%")
        self.succeeds("fill", "a.tif", "w.tif", "-m", "mcmd")
        for options in ([], self.memory):
            self.succeeds("fill", "a.tif", "o.vrt", "-m", "mcmd", "--overwrite", *options)
            self.assertEqual(sorted(os.listdir(self.path("o_tiles"))), ["000_000.tif", "000_001.tif"])
            self.assertEqual(self.cells("o.vrt"), self.cells("w.tif"))
        self.fails(2, "fill", "a.tif", "o.vrt", says=["o.vrt", "--overwrite"])
        os.remove(self.path("o_tiles/000_001.tif"))
        for options in ([], self.memory):
            self.fails(2, "fill", "o.vrt", "again.tif", *options, says=["o.vrt", "000_001.tif"])
        self.assertFalse(os.path.exists(self.path("again.tif")))


class AnySize(HoleTest):
    memory = ["--memory", "300M"]

    @slow
    @unittest.skipIf("DEM_SANITIZED" in os.environ, "AddressSanitizer takes terabytes of address space")
    def test_memory_is_a_bound_that_the_system_may_enforce(self):
        self.succeeds("generate", "noise", "n.tif", "--size", "3000", "--cell", "30")
        self.succeeds("sample", "n.tif", "a.tif", "--voids", "20%")
        self.fails(2, "fill", "a.tif", "o.tif", "--whole", preexec_fn=limit_memory(650 << 20))
        self.assert_files("n.tif", "a.tif")
        self.succeeds("fill", "a.tif", "o.tif", *self.memory, preexec_fn=limit_memory(650 << 20))

    def test_part_by_part_gives_the_same_cells_as_whole(self):
        for type_, methods in (("int16", ("spline",)), ("float32", ("mcmd",)), ("int32", ("mcmd",))):
            self.pitted(type_=type_)
            for method in methods:
                whole = self.json("fill", "a.tif", "w.tif", "-m", method, "--sigma", "ws.tif",
                                  "--source", "wk.tif", "--overwrite") if method == "spline" else \
                    self.json("fill", "a.tif", "w.tif", "-m", method, "--source", "wk.tif", "--overwrite")
                layers = ["--source", "pk.tif"] + (["--sigma", "ps.tif"] if method == "spline" else [])
                parts = self.json("fill", "a.tif", "p.tif", "-m", method, *layers, "--overwrite",
                                  "-j", "2", *self.memory)
                self.assertEqual(whole["known_checksum"], parts["known_checksum"])
                for key in ("filled", "voids", "windows", "left", "known_unchanged"):
                    self.assertEqual(whole[key], parts[key], key)
                self.assertEqual(self.cells("w.tif"), self.cells("p.tif"))
                self.assertEqual(self.cells("wk.tif"), self.cells("pk.tif"))
                if method == "spline":
                    self.assertEqual(self.cells("ws.tif"), self.cells("ps.tif"))

    def test_holes_across_the_seams_of_a_mosaic_are_one(self):
        for col in range(2):
            self.hgt(f"N10E01{col}.hgt", 33,
                     lambda c, r, o=32 * col: VOID if 28 <= c + o < 36 and 5 <= r < 12 else height(c + o, r))
        tiles = "".join(
            f'<SimpleSource><SourceFilename relativeToVRT="1">N10E01{i}.hgt</SourceFilename>'
            f'<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="33" ySize="33"/>'
            f'<DstRect xOff="{32 * i}" yOff="0" xSize="33" ySize="33"/></SimpleSource>' for i in range(2))
        for name in os.listdir(self.dir):  # GDAL's driver knows tiles of 1201 cells only
            if name.endswith(".hgt"):
                self.succeeds("fill", name, name[:-4] + ".tif", "--where", "cells < 0")
        tiles = tiles.replace(".hgt", ".tif")
        self.write("m.vrt", '<VRTDataset rasterXSize="65" rasterYSize="33"><GeoTransform>10,0.03125,0,'
                            '11,0,-0.03125</GeoTransform><VRTRasterBand dataType="Int16" band="1">'
                            f'<NoDataValue>-32768</NoDataValue>{tiles}</VRTRasterBand></VRTDataset>')
        report = self.json("fill", "m.vrt", "o.tif", *self.memory)
        self.assertEqual((report["voids"], report["filled"], report["left"]), (1, 56, 0))
        self.succeeds("fill", "m.vrt", "w.tif")
        self.assertEqual(self.cells("o.tif"), self.cells("w.tif"))

    def test_cog_is_written(self):
        self.pitted()
        self.succeeds("fill", "a.tif", "o.tif", "--format", "COG", *self.memory)
        self.assertIn(b"LAYOUT=IFDS_BEFORE_DATA", self.read("o.tif")[:200])
        self.succeeds("fill", "a.tif", "w.tif")
        self.assertEqual(self.cells("o.tif"), self.cells("w.tif"))
        self.assertFalse([n for n in os.listdir(self.dir) if n.startswith(".")])

    def test_too_little_memory_says_how_much_would_do(self):
        self.pitted()
        self.fails(1, "fill", "a.tif", "o.tif", "--memory", "1M", says=["memory = 1M", "at least"])
        self.fails(1, "fill", "a.tif", "o.tif", "--memory", "much", says=["memory = much", "2G"])

    def test_formats_that_need_the_whole_raster_are_refused(self):
        self.pitted()
        self.fails(2, "fill", "a.tif", "o.asc", *self.memory, says=["o.asc", "GTiff, COG"])

    def test_full_disk_leaves_the_old_file_and_no_journal(self):
        noise = random.Random(1)
        self.hgt("N10E010.hgt", 257, lambda c, r: VOID if c % 9 == 0 else noise.randrange(30000))
        self.succeeds("fill", "N10E010.hgt", "a.tif", "--where", "cells < 0")
        self.write("o.tif", "mine")
        self.fails(2, "fill", "a.tif", "o.tif", "--overwrite", *self.memory,
                   preexec_fn=limit_file_size(20000))
        self.assertEqual(self.read("o.tif"), b"mine")
        self.assert_files("N10E010.hgt", "a.tif", "o.tif")


class Resume(HoleTest):
    @slow
    def test_after_kill_at_any_moment_the_same_command_ends_in_the_same_bytes(self):
        self.pitted(side=500)
        command = ["fill", "a.tif", "o.tif", "--resume", "-q", "-j", "1", "--overwrite"]
        begin = time.monotonic()
        self.succeeds(*command)
        whole_time = time.monotonic() - begin
        expected = self.read("o.tif")
        dice = random.Random(5)
        killed = 0
        for _ in range(KILLS):
            os.remove(self.path("o.tif"))
            for _ in range(3):  # killed twice before it may end
                run = subprocess.Popen([DEM, *command], cwd=self.dir)
                time.sleep(dice.uniform(0, whole_time) if killed else 0.05)  # once for sure
                run.kill()
                killed += run.wait() == -signal.SIGKILL
                if os.path.exists(self.path("o.tif")):
                    self.assertEqual(self.read("o.tif"), expected)
            self.succeeds(*command)
            self.assertEqual(self.read("o.tif"), expected)
            self.assertFalse([n for n in os.listdir(self.dir) if n.endswith(".journal")])
        self.assertGreater(killed, 0)

    def has_windows(self, journal):
        return os.path.exists(self.path(journal)) and os.path.getsize(self.path(journal)) > 20000

    def test_stop_signal_keeps_the_journal_only_with_resume(self):
        self.pitted(side=600, share=0.2)
        for options, kept in ((["--memory", "400M"], False), (["--resume"], True)):
            run = subprocess.Popen([DEM, "fill", "a.tif", "o.tif", "--progress", "json", *options],
                                   cwd=self.dir, text=True, stderr=subprocess.PIPE)
            for line in run.stderr:
                if "filling" in line and (not kept or self.has_windows(".o.tif.journal")):
                    break
            run.send_signal(signal.SIGTERM)
            run.communicate(timeout=60)
            self.assertEqual(run.returncode, 5)
            self.assertEqual(os.path.exists(self.path(".o.tif.journal")), kept)
        self.assertIn("resumed", self.succeeds("fill", "a.tif", "o.tif", "--resume").stderr)

    def test_journal_of_another_run_is_not_used(self):
        self.pitted(side=300)
        self.succeeds("fill", "a.tif", "w.tif", "-m", "mcmd")
        self.write(".o.tif.journal", b"of something else" * 100)
        self.succeeds("fill", "a.tif", "o.tif", "-m", "mcmd", "--resume")
        self.assertEqual(self.cells("o.tif"), self.cells("w.tif"))

    def test_tasks_leave_shares_from_which_resume_writes_the_same_bytes(self):
        self.pitted(side=400)
        command = ["fill", "a.tif", "o.tif", "--memory", "400M"]
        self.succeeds(*command, "--resume")
        expected = self.read("o.tif")
        os.remove(self.path("o.tif"))
        reports = [self.json(*command, "--task", f"{i}/3") for i in (3, 1)]
        self.assertFalse(os.path.exists(self.path("o.tif")))
        journal = self.read(".o.tif.journal.3of3")
        self.write(".o.tif.journal.3of3", journal[: len(journal) // 2])  # as after a kill
        self.assertEqual(self.json(*command, "--task", "3/3")["filled"], reports[0]["filled"])
        reports.append(self.json(*command, "--task", "2/3"))
        cells = [r["filled"] for r in reports]
        self.assertGreater(min(cells), max(cells) / 4)
        run = self.succeeds(*command, "--resume")
        self.assertIn(f"filled {sum(cells):,} of".replace(",", " "), run.stderr)
        self.assertRegex(run.stderr, r"resumed: (\S+) of \1 windows were done")
        self.assertEqual(self.read("o.tif"), expected)
        self.assert_files("a.tif", "o.tif")

    def test_resume_does_what_tasks_have_not_done(self):
        self.pitted(side=300)
        self.succeeds("fill", "a.tif", "w.tif")
        self.succeeds("fill", "a.tif", "o.tif", "--task", "2/2")
        self.assertIn("resumed", self.succeeds("fill", "a.tif", "o.tif", "--resume").stderr)
        self.assertEqual(self.cells("o.tif"), self.cells("w.tif"))

    def test_bad_tasks_are_refused(self):
        self.pitted(side=64)
        for task in "0/3", "4/3", "1.5/3", "2", "/", "1/200000":
            self.fails(1, "fill", "a.tif", "o.tif", "--task", task, says=[f"task = {task}", "1 <= I <= N"])
        self.fails(1, "fill", "a.tif", "o.tif", "--task", "1/2", "--resume", says=["no --resume"])
        self.succeeds("fill", "a.tif", "o.tif", "--task", "1/2")
        self.fails(2, "fill", "a.tif", "o.tif", "--resume", "-m", "mcmd",
                   says=[".o.tif.journal.1of2", "other settings", "remove it"])


if __name__ == "__main__":
    main()
