"""The package and the command line give the same bits."""

import json

import numpy as np
import pytest
from conftest import equal_bits

import libdem


@pytest.fixture
def holed_file(holed, tmp_path):
    libdem.write(tmp_path / "holed.tif", holed)
    return "holed.tif"


@pytest.mark.parametrize("keywords, options", [
    ({}, []),
    ({"threads": 1}, []),
    ({"method": "mcmd:paper"}, ["--method", "mcmd:paper"]),
    ({"method": "mcmd", "I": 0.3, "rs": 0.5, "seed": 7},
     ["--method", "mcmd", "-s", "I=0.3", "-s", "rs=0.5", "--seed", "7"]),
    ({"inner_only": True}, ["--inner-only"]),
    ({"where": "cells < 100"}, ["--where", "cells < 100"]),
    ({"whole": True, "adaptive": False}, ["--whole", "-s", "adaptive=false"]),
])
def test_fill(holed, holed_file, dem, tmp_path, keywords, options):
    report = json.loads(dem("fill", holed_file, "out.tif", "--type", "float32", "--json", "--source", "source.tif",
                            *options))
    filled = libdem.fill(holed, **keywords)
    out = libdem.read(tmp_path / "out.tif")
    assert equal_bits(filled.elevation, out.z)
    assert np.array_equal(filled.dem.known, out.known)
    assert np.array_equal(filled.source, libdem.read(tmp_path / "source.tif").z)
    for name in set(filled.report) - {"seconds", "report", "method", "settings"}:
        assert filled.report[name] == report[name], name
    assert set(report) - set(filled.report) == {"output"}


def test_sigma(holed, holed_file, dem, tmp_path):
    dem("fill", holed_file, "out.tif", "--sigma", "sigma.tif")
    assert equal_bits(libdem.fill(holed, sigma=True).sigma, libdem.read(tmp_path / "sigma.tif").z)


def test_fill_of_a_plain_array_is_that_of_a_file_without_coordinates(hills, dem, tmp_path):
    hills[10:17, 20:29] = np.nan
    libdem.write(tmp_path / "in.tif", hills, spacing=(30, 20))
    dem("fill", "in.tif", "out.tif")
    assert equal_bits(libdem.fill(hills, spacing=(30, 20)).elevation, libdem.read(tmp_path / "out.tif").z)


@pytest.mark.parametrize("keywords, options", [
    ({"keep": 0.05, "seed": 4}, ["--keep", "5%", "--seed", "4"]), ({"every": 7}, ["--every", "7"]),
    ({"edges": 0.1}, ["--edges", "10%"]), ({"voids": 0.1}, ["--voids", "10%"]), ({"tracks": 9}, ["--tracks", "9"]),
    ({"contours_m": 20}, ["--contours", "20"]),
    ({"greedy": 500, "method": "mcmd"}, ["--greedy", "500", "-m", "mcmd"]),
])
def test_sample(whole, testdata, dem, tmp_path, keywords, options):
    dem("sample", testdata / "jacksboro.tif", "out.tif", *options)
    got, out = libdem.sample(whole, **keywords), libdem.read(tmp_path / "out.tif")
    assert np.array_equal(got.known, out.known)
    assert equal_bits(got.z, out.z)


def test_evaluate(whole, holed, holed_file, testdata, dem, tmp_path):
    filled = libdem.fill(holed)
    libdem.write(tmp_path / "filled.tif", filled, dtype="float32")
    told = json.loads(dem("evaluate", testdata / "jacksboro.tif", "filled.tif", "--known", holed_file, "--json"))
    scores = libdem.evaluate(whole, filled, holed)
    assert vars(scores.all) == told["all"]
    assert vars(scores.filled) == told["filled"]
    assert scores.spectrum.got_m4.tolist() == [row["got_m4"] for row in told["spectrum"]]


@pytest.mark.parametrize("preserve", ["heights", "block-mean"])
def test_supersample(testdata, dem, tmp_path, preserve):
    coarse = libdem.sample(libdem.read(testdata / "olinda.tif"), voids=0.02)
    libdem.write(tmp_path / "coarse.tif", coarse)
    dem("supersample", "coarse.tif", "fine.tif", "--factor", "2.5", "--preserve", preserve)
    fine, out = libdem.supersample(coarse, 2.5, preserve=preserve), libdem.read(tmp_path / "fine.tif")
    assert equal_bits(fine.elevation, out.z)
    assert fine.dem.to_world == pytest.approx(out.to_world, rel=1e-12)


@pytest.mark.parametrize("keywords, options", [
    ({}, []), ({"cell": 2}, ["--cell", "2m"]),
    ({"cell": "2m", "bounds": (10, 10, 90, 80), "nodes": True, "method": "mcmd"},
     ["--cell", "2m", "--bounds", "10,10,90,80", "--nodes", "--method", "mcmd"]),
    ({"cell": "3m", "combine": "max", "snap": True}, ["--cell", "3m", "--combine", "max", "--snap"]),
])
def test_grid(dem, tmp_path, keywords, options):
    rng = np.random.default_rng(5)
    x, y = rng.uniform(0, 100, (2, 400))
    z = (50 + 10 * np.sin(x / 9) + y / 5).astype(np.float32)
    (tmp_path / "p.csv").write_text("x,y,z\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in zip(x, y, z.tolist())))
    dem("grid", "p.csv", "out.tif", *options)
    got, out = libdem.grid(x, y, z, **keywords), libdem.read(tmp_path / "out.tif")
    assert equal_bits(got.elevation, out.z)
    assert got.dem.to_world == pytest.approx(out.to_world, rel=1e-12)


def geojson(path, lines):
    """Lines of a list of (height, xy), in EPSG:32632."""
    features = [{"type": "Feature", "properties": {"height": height},
                 "geometry": {"type": "LineString", "coordinates": np.asarray(xy).tolist()}} for height, xy in lines]
    crs = {"type": "name", "properties": {"name": "EPSG:32632"}}
    path.write_text(json.dumps({"type": "FeatureCollection", "crs": crs, "features": features}))


@pytest.fixture
def hill_points(tmp_path):
    """Points of a step with its file p.csv, in EPSG:32632."""
    x, y = np.random.default_rng(5).uniform(0, 400, (2, 600))
    x, y, z = x + 500000, y + 5200000, (50 + 9 * np.sin(y / 40) + 60 * (x > 200)).astype(np.float32)
    (tmp_path / "p.csv").write_text("x,y,z\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in
                                                      zip(x.tolist(), y.tolist(), z.tolist())))
    return x, y, z


def expect_grid(dem, tmp_path, options, *results):
    """All results equal what the command line writes, and report the same."""
    told = json.loads(dem("grid", *options, "out.tif", "--json"))
    out = libdem.read(tmp_path / "out.tif")
    for got in results:
        assert equal_bits(got.elevation, out.elevation)
        assert got.dem.crs == out.crs
        assert np.array_equal(got.dem.known, out.known)
        for name in set(got.report) & set(told) - {"format", "notes", "seconds", "lattice_from"}:
            assert got.report[name] == told[name], name


def test_grid_of_a_file_in_another_system(dem, tmp_path, hill_points):
    systems = {"crs": "EPSG:32632", "to_crs": "EPSG:3035"}
    options = ["p.csv", "--crs", "EPSG:32632", "--to-crs", "EPSG:3035", "--cell", "10m"]
    expect_grid(dem, tmp_path, options, libdem.grid(*hill_points, cell=10, **systems),
                libdem.grid(tmp_path / "p.csv", cell=10, **systems))
    expect_grid(dem, tmp_path, ["p.csv", "--cell", "10m", "--no-fill", "--z-field", "z", "--delimiter", ",",
                                "--overwrite"],
                libdem.grid(tmp_path / "p.csv", cell=10, no_fill=True, z_field="z", delimiter=","))


def test_grid_like_another_dem(dem, tmp_path, hill_points):
    like = libdem.grid(*hill_points, cell=10, crs="EPSG:32632", to_crs="EPSG:3035")
    libdem.write(tmp_path / "like.tif", like)
    expect_grid(dem, tmp_path, ["p.csv", "--crs", "EPSG:32632", "--like", "like.tif", "--method", "mcmd"],
                libdem.grid(*hill_points, crs="EPSG:32632", like=like, method="mcmd"))


def test_grid_with_breaklines(dem, tmp_path, hill_points):
    wall = np.array([[500200, 5199900], [500200, 5200300], [500210, 5200500]])
    geojson(tmp_path / "wall.geojson", [(0, wall)])
    options = ["p.csv", "--crs", "EPSG:32632", "--cell", "10m", "--breaklines", "wall.geojson"]
    keywords = {"crs": "EPSG:32632", "cell": 10}
    expect_grid(dem, tmp_path, options,
                libdem.grid(*hill_points, breaklines=tmp_path / "wall.geojson", **keywords),
                libdem.grid(*hill_points, breaklines=[wall], **keywords))


def test_grid_of_contour_lines(dem, tmp_path):
    angle = np.arange(190) / 30
    lines = [(level, np.stack([500000 + 5 * (100 - level) * np.cos(angle),
                               5200000 + 5 * (100 - level) * np.sin(angle)], axis=1)) for level in range(20, 100, 20)]
    geojson(tmp_path / "c.geojson", lines)
    options = ["c.geojson", "--contours", "--cell", "10m", "--z-field", "height"]
    got = [libdem.grid(contours=tmp_path / "c.geojson", cell=10, z_field="height"),
           libdem.grid(contours=lines, cell=10, crs="EPSG:32632")]
    expect_grid(dem, tmp_path, options, *got)
    assert got[0].report["method"] == "contours"
    expect_grid(dem, tmp_path, [*options, "--to-crs", "EPSG:3035", "--method", "spline", "--overwrite"],
                libdem.grid(contours=lines, cell=10, crs="EPSG:32632", to_crs="EPSG:3035", method="spline"))


@pytest.mark.parametrize("name, keywords, options", [
    ("noise:foothills", {"seed": 7}, ["--seed", "7"]),
    ("noise", {"H": 0.9, "spacing": (10, 20), "origin": (305000, 4910000), "crs": "EPSG:32619"},
     ["-s", "H=0.9", "--cell", "10x20", "--origin", "305000,4910000", "--crs", "EPSG:32619"]),
    ("globe", {"count": 50, "median": 1}, ["-s", "count=50", "--median", "1"]),
])
def test_generate(dem, tmp_path, name, keywords, options):
    dem("generate", name, "out.tif", "--size", "60x50", *options)
    got, out = libdem.generate(name, (50, 60), **keywords), libdem.read(tmp_path / "out.tif")
    assert equal_bits(got.z, out.z)
    assert got.to_world == pytest.approx(out.to_world, rel=1e-12)


def test_generate_from_lines(testdata, dem, tmp_path):
    options = {"shape": (80, 90), "spacing": 30}
    dem("generate", "skeleton", testdata / "lines.geojson", "out.tif", "--size", "90x80")
    got = libdem.generate("skeleton", image=testdata / "lines.geojson", **options)
    assert equal_bits(got.z, libdem.read(tmp_path / "out.tif").z)


def test_erode(testdata, dem, tmp_path):
    dem("erode", testdata / "olinda.tif", "out.tif", "-s", "steps=120", "--water", "water.tif")
    worn = libdem.erode(libdem.read(testdata / "olinda.tif"), steps=120)
    assert equal_bits(worn.elevation, libdem.read(tmp_path / "out.tif").z)
    assert equal_bits(worn.water_m, libdem.read(tmp_path / "water.tif").z)


@pytest.mark.parametrize("style, keywords, options", [
    ("hillshade", {"multidirectional": True}, ["--multidirectional"]),
    ("relief", {"palette": "dusk"}, ["--palette", "dusk"]),
    ("view", {"width": 160, "height": 90, "shadows": False}, ["--size", "160x90", "--no-shadows"]),
])
def test_render(whole, testdata, dem, tmp_path, style, keywords, options):
    rasterio = pytest.importorskip("rasterio", reason="python3-rasterio is missing")
    dem("render", testdata / "jacksboro.tif", "out.png", "--style", style, *options)
    with rasterio.open(tmp_path / "out.png") as file:
        out = np.moveaxis(file.read(), 0, -1).squeeze()
    assert np.array_equal(libdem.render(whole, style, **keywords), out)


def test_tables(dem):
    told = json.loads(dem("methods", "--json"))
    for rows, here in (told["fill"], libdem.methods()), (told["generators"], libdem.generators()):
        assert [row["name"] for row in rows] == list(here)
        for row in rows:
            assert [f["name"] for f in row["fields"]] == [f.name for f in here[row["name"]].fields]
            assert [p["name"] for p in row["presets"]] == [p.name for p in here[row["name"]].presets]
