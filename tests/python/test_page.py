"""The Python of docs/python.md runs as it stands there."""
import json
import pathlib
import re

import numpy
import pytest

import libdem

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/python.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)


@pytest.fixture(autouse=True)
def files(tmp_path, monkeypatch):
    """The files that the page names."""
    monkeypatch.chdir(tmp_path)
    z = libdem.generate("noise", (65, 65), seed=3, spacing=90).elevation
    z = numpy.round(z).astype("int16")
    z[20:30, 20:40] = -32768
    pathlib.Path("N36E008.hgt").write_bytes(z.astype(">i2").tobytes())
    libdem.write("sparse.tif", libdem.sample(libdem.generate("noise", (80, 90), seed=4, spacing=30), keep=0.2))
    lon, lat = numpy.random.default_rng(2).uniform((8, 47), (8.02, 47.02), (300, 2)).T
    numpy.savetxt("soundings.csv", numpy.stack([lon, lat, -20 + 900 * (lat - 47)], axis=1), delimiter=",",
                  header="lon,lat,z", comments="")
    features = [{"type": "Feature", "properties": {"height": height}, "geometry": {
        "type": "LineString", "coordinates": [[0, 3 * height], [400, 4 * height]]}} for height in range(20, 100, 20)]
    crs = {"type": "name", "properties": {"name": "EPSG:32632"}}
    pathlib.Path("map.geojson").write_text(json.dumps(
        {"type": "FeatureCollection", "crs": crs, "features": features}))


@pytest.mark.parametrize("block", [b for b in BLOCKS if "Client(" not in b])  # the cluster: test_distributed.py
def test_block(block):
    names = {}
    exec(compile(block, str(PAGE), "exec"), names)
    assert "libdem" in names


def test_first_block_leaves_a_filled_file():
    exec(compile(BLOCKS[0], str(PAGE), "exec"), {})
    assert not numpy.isnan(libdem.read("filled.tif").elevation).any()
