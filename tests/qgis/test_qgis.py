"""The QGIS plugin, without a window: qgis_process lists and runs its algorithms. Their outputs are those of `dem`."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

DEM = os.path.abspath(os.environ["DEM_BINARY"])
ZIP = os.environ["DEM_QGIS_ZIP"]
# Debian wraps it in a script that passes an option of QGIS's window, which it does not know.
PROGRAM = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
ROOT = pathlib.Path(__file__).resolve().parents[2]


class Qgis(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = pathlib.Path(tempfile.mkdtemp(prefix="dem-qgis-"))
        plugins = cls.home / ".local/share/QGIS/QGIS3/profiles/default/python/plugins"
        plugins.mkdir(parents=True)
        shutil.unpack_archive(ZIP, plugins)
        cls.environment = {**os.environ, "HOME": str(cls.home), "QT_QPA_PLATFORM": "offscreen", "LC_ALL": "C.UTF-8",
                           "XDG_RUNTIME_DIR": str(cls.home), "PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}
        cls.process("plugins", "enable", "libdem_processing")
        # A copy: QGIS writes statistics beside the files that it opens.
        cls.tile = shutil.copy(ROOT / "testdata" / "jacksboro.tif", cls.home)
        cls.voids = str(cls.home / "voids.tif")
        subprocess.run([DEM, "sample", cls.tile, cls.voids, "--voids", "5%", "--quiet"], check=True, timeout=60)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.home)

    @classmethod
    def process(cls, *arguments, path=os.path.dirname(DEM), check=True):
        environment = {**cls.environment, "PATH": f"{path}:/usr/bin:/bin"}
        done = subprocess.run([PROGRAM, *arguments], env=environment, capture_output=True, text=True, timeout=120)
        if check and done.returncode != 0:
            raise AssertionError(f"qgis_process {arguments}: {done.stdout}{done.stderr}")
        return done

    def run_algorithm(self, name, **values):
        given = [f"--{key}={value}" for key, value in values.items()]
        return json.loads(self.process("run", f"dem:{name}", "--json", *given).stdout)["results"]

    def file(self, name):
        return str(self.home / name)

    def cells(self, name):
        """The bytes of all cells, and their place: files may differ in what they say of their making only."""
        program = ("import sys; from osgeo import gdal; d = gdal.Open(sys.argv[1]); "
                   "sys.stdout.buffer.write(d.ReadRaster() + repr((d.GetGeoTransform(), d.GetProjection())).encode())")
        return subprocess.run(["/usr/bin/python3", "-c", program, self.file(name)], capture_output=True,
                              check=True).stdout

    def test_every_algorithm_is_listed(self):
        listed = json.loads(self.process("list", "--json").stdout)["providers"]["dem"]["algorithms"]
        methods = subprocess.run([DEM, "methods", "--json"], capture_output=True, check=True).stdout
        generators = json.loads(methods)["generators"]
        self.assertEqual({name.split(":")[1] for name in listed},
                         {"inspect_voids", "fill_voids", "grid_points", "supersample", "evaluate", "erode", "hillshade",
                          *(f"generate_{g['name']}" for g in generators)})

    def test_fill_voids_gives_the_bytes_of_the_command_line(self):
        results = self.run_algorithm("fill_voids", INPUT=self.voids, METHOD="mcmd:paper", MCMD_I="0.4",
                                     INNER_ONLY="true", OUTPUT=self.file("a.tif"), SOURCE=self.file("source.tif"))
        subprocess.run([DEM, "fill", self.voids, self.file("b.tif"), "--method", "mcmd:paper", "--set", "I=0.4",
                        "--inner-only", "--source", self.file("b_source.tif"), "--quiet"], check=True, timeout=60)
        self.assertEqual(self.cells("a.tif"), self.cells("b.tif"))
        self.assertEqual(pathlib.Path(self.file("source.tif")).read_bytes(),
                         pathlib.Path(self.file("b_source.tif")).read_bytes())
        self.assertEqual(results["METHOD"], "mcmd:paper")
        self.assertGreater(results["FILLED"], 0)

    def test_inspect_voids_gives_the_bytes_of_the_command_line(self):
        results = self.run_algorithm("inspect_voids", INPUT=self.voids, HOLES=self.file("a.geojson"))
        subprocess.run([DEM, "info", self.voids, "--holes", self.file("b.geojson"), "--quiet"], check=True, timeout=60,
                       stdout=subprocess.DEVNULL)
        a, b = (json.loads(pathlib.Path(self.file(n)).read_text()) for n in ("a.geojson", "b.geojson"))
        self.assertEqual(a["features"], b["features"])
        self.assertEqual(results["VOIDS"], len(a["features"]))

    def test_error_of_the_program_is_one_line(self):
        done = self.process("run", "dem:fill_voids", f"--INPUT={self.voids}", "--METHOD=mcmd", "--WHERE=colour = 3",
                            f"--OUTPUT={self.file('no.tif')}", check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("colour", done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stdout + done.stderr)
        self.assertFalse(os.path.exists(self.file("no.tif")))

    def test_setting_of_another_method_is_refused(self):
        done = self.process("run", "dem:fill_voids", f"--INPUT={self.voids}", "--METHOD=mcmd", "--SPLINE_L1=3",
                            f"--OUTPUT={self.file('no.tif')}", check=False)
        self.assertIn("spline L1 = 3; the method is mcmd", done.stdout + done.stderr)

    def test_without_the_program_one_line_says_where_to_set_it(self):
        done = self.process("run", "dem:fill_voids", f"--INPUT={self.voids}", f"--OUTPUT={self.file('no.tif')}",
                            path="/nowhere", check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("Settings > Options > Processing > Providers > libdem", done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stdout + done.stderr)

    def test_inside_qgis(self):
        """The other algorithms, progress, stopping, styles, the path as a setting: in one process (inside.py)."""
        python = subprocess.run(["/usr/bin/python3", ROOT / "tests/qgis/inside.py", self.voids, self.tile, DEM],
                                timeout=300, capture_output=True, text=True, cwd=self.home, env=self.environment)
        self.assertEqual(python.returncode, 0, python.stdout + python.stderr)


if __name__ == "__main__":
    if not PROGRAM:
        print("qgis_process is not installed: apt-get install --no-install-recommends qgis")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=1)
