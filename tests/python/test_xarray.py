"""The accessor of xarray."""

import numpy as np
import pytest
from conftest import equal_bits

import libdem

xr = pytest.importorskip("xarray", reason="python3-xarray is missing")
rioxarray = pytest.importorskip("rioxarray", reason="python3-rioxarray is missing")
import libdem.xarray  # noqa: E402


@pytest.fixture
def opened(holed, tmp_path):
    libdem.write(tmp_path / "holed.tif", holed)
    with rioxarray.open_rasterio(tmp_path / "holed.tif") as array:
        yield array.load()


def test_fill_is_that_of_the_file_and_keeps_what_xarray_knows(opened, holed):
    opened.attrs["station"] = "north"
    for array in opened, opened.squeeze("band"), opened.squeeze("band").transpose("x", "y"):
        filled = array.dem.fill()
        assert filled.dims == array.dims and filled.shape == array.shape
        plane = filled.squeeze().transpose("y", "x").values
        assert equal_bits(np.ascontiguousarray(plane), libdem.fill(holed).elevation)
        assert filled.rio.crs == array.rio.crs and filled.rio.transform() == array.rio.transform()
        assert filled.attrs == array.attrs
        assert all(filled[c].equals(array[c]) for c in array.coords)


def test_rows_may_run_north(opened, holed):
    turned = opened.squeeze("band").isel(y=slice(None, None, -1))
    filled = turned.dem.fill()
    assert equal_bits(np.ascontiguousarray(filled.values[::-1]), libdem.fill(holed).elevation)
    assert filled.y.equals(turned.y)


def test_full_gives_layers(opened):
    layers = opened.squeeze("band").dem.fill(sigma=True, full=True)
    assert set(layers) == {"elevation", "source", "sigma"}
    assert layers.source.attrs["class_1"] == "method"
    assert (layers.sigma.values[layers.source.values == 0] == 0).all()


def test_supersample_gives_finer_coordinates(opened):
    part = opened.squeeze("band").isel(x=slice(40), y=slice(30))
    fine = part.dem.supersample(2)
    assert fine.shape == (60, 80) and fine.rio.crs == part.rio.crs
    assert fine.x.values[:2].mean() == pytest.approx(part.x.values[0], abs=1e-9)
    assert fine.y.values[:2].mean() == pytest.approx(part.y.values[0], abs=1e-9)


def test_plain_functions_take_dataarrays(opened, holed):
    assert equal_bits(libdem.fill(opened).elevation, libdem.fill(holed).elevation)


def test_several_bands_are_refused(opened):
    message = r"the array has 2 values along band; must be one, choose it by .isel\(band=0\)"
    with pytest.raises(ValueError, match=message):
        xr.concat([opened, opened], "band").dem.fill()
