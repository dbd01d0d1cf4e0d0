"""Runs in Debian's Python with QGIS as a library: inside.py VOIDS TILE DEM, in a folder of its own."""

import json
import os
import pathlib
import sys
import time
import traceback

sys.path.insert(0, "/usr/share/qgis/python/plugins")
sys.path.insert(0, os.path.expanduser("~/.local/share/QGIS/QGIS3/profiles/default/python/plugins"))

from qgis.core import (QgsApplication, QgsProcessingContext, QgsProcessingException, QgsProcessingFeedback,
                       QgsRasterLayer)

VOIDS, TILE, DEM = sys.argv[1:]
application = QgsApplication([], False)
application.initQgis()

import processing
from processing.core.Processing import Processing
from processing.core.ProcessingConfig import ProcessingConfig

Processing.initialize()
import libdem_processing
from libdem_processing import algorithms, tool
from libdem_processing.provider import SETTING

plugin = libdem_processing.classFactory(None)
plugin.initProcessing()
ProcessingConfig.setSettingValue(SETTING, DEM)  # it is not on the path here
plugin.provider.refreshAlgorithms()


class Feedback(QgsProcessingFeedback):
    def __init__(self, stop_at=2.0):
        super().__init__()
        self.parts, self.stop_at = [], stop_at
        self.progressChanged.connect(self.take)

    def take(self, part):
        self.parts.append(part)
        if part / 100 >= self.stop_at:
            self.cancel()


def run(name, feedback=None, **values):
    return processing.run(f"dem:{name}", values, feedback=feedback or Feedback())


def check(truth, what):
    if not truth:
        raise AssertionError(what)


def leave(kind, error, trace):
    """At once: QGIS does not survive being taken apart in the middle."""
    traceback.print_exception(kind, error, trace)
    sys.stderr.flush()
    os._exit(1)


sys.excepthook = leave


# The other algorithms.
made = run("generate_noise", PRESET="foothills", SIZE="65", CELL="30", CRS="EPSG:32619", ORIGIN="305000,4910000",
           SEED=7, OUTPUT="hills.tif")
layer = QgsRasterLayer(made["OUTPUT"])
check(layer.isValid() and layer.width() == 65 and layer.crs().authid() == "EPSG:32619", "generate")
check(run("erode", INPUT="hills.tif", STEPS=20, OUTPUT="eroded.tif")["STEPS"] == 20, "erode")
check(run("supersample", INPUT="hills.tif", FACTOR=2, OUTPUT="fine.tif")["COLS"] in (129, 130), "supersample")
filled = run("fill_voids", INPUT=VOIDS, OUTPUT="filled.tif", SIGMA="sigma.tif", SOURCE="source.tif")
check(filled["LEFT"] == 0, "fill")
score = run("evaluate", TRUTH=TILE, GOT="filled.tif", KNOWN=VOIDS)
check(0 < score["RMSE_M"] < 100, "evaluate")
run("hillshade", INPUT=TILE, MULTIDIRECTIONAL=True, AZIMUTH=300, OUTPUT="shade.tif")
check(QgsRasterLayer("shade.tif").extent() == QgsRasterLayer(TILE).extent(), "the hillshade lies where the DEM lies")
lines = [f"{x},{y},{x + y}\n" for x in range(0, 300, 30) for y in range(0, 300, 30)]
pathlib.Path("points.csv").write_text("x,y,z\n" + "".join(lines))
run("grid_points", POINTS_FILE="points.csv", CELL="10m", TO_CRS=None, OUTPUT="grid.tif")
check(QgsRasterLayer("grid.tif").width() > 20, "points of a file")
pathlib.Path("points.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"h": x + y},
     "geometry": {"type": "Point", "coordinates": [8 + x / 1e3, 46 + y / 1e3]}}
    for x in range(10) for y in range(10)]}))
run("grid_points", POINTS="points.geojson", Z_FIELD="h", TO_CRS="EPSG:32632", CELL="30m", OUTPUT="layer.tif")
check(QgsRasterLayer("layer.tif").crs().authid() == "EPSG:32632", "points of a layer")

# Styles fit the layers that they are for.
for name in ("source", "sigma"):
    layer = QgsRasterLayer(f"{name}.tif")
    text, good = layer.loadNamedStyle(os.path.join(algorithms.STYLES, f"{name}.qml"))
    check(good and layer.renderer().type() in ("paletted", "singlebandpseudocolor"), f"style of {name}: {text}")

# Progress comes, and a stop leaves nothing behind.
run("generate_noise", SIZE="1500", OUTPUT="big.tif")
steps = Feedback()
run("erode", INPUT="big.tif", STEPS=60, OUTPUT="big_eroded.tif", feedback=steps)
check(len(steps.parts) > 3 and steps.parts == sorted(steps.parts), f"progress: {steps.parts}")
stopped, start = Feedback(stop_at=0.05), time.monotonic()
result = run("erode", INPUT="big.tif", STEPS=100000, OUTPUT="never.tif", feedback=stopped)
check(stopped.isCanceled() and not os.path.exists("never.tif"), "a stopped run leaves no output")
check([n for n in os.listdir(".") if n.startswith("never")] == [], "a stopped run leaves nothing")

# A wrong path is one line that says where to set it.
ProcessingConfig.setSettingValue(SETTING, TILE)
try:
    run("erode", INPUT="hills.tif", OUTPUT="x.tif")
    check(False, "a wrong path must be refused")
except QgsProcessingException as error:
    check(TILE in str(error) and "Providers > libdem" in str(error), str(error))
print("all right")
sys.stdout.flush()
os._exit(0)
