"""Arrays in and out: what they may be, what is copied, and what is said of those that will not do."""

import numpy as np
import pytest
from conftest import equal_bits
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as some

import libdem

DTYPES = [np.float32, np.float64, np.int16, np.uint16, np.int8, np.uint8, np.int32, np.uint32, np.int64, np.float16,
          ">i2", ">f4"]
few = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


@st.composite
def holed_arrays(draw):
    dtype = np.dtype(draw(st.sampled_from(DTYPES)))
    shape = draw(some.array_shapes(min_dims=2, max_dims=2, max_side=12))
    low, high = (0, 100) if dtype.kind == "u" else (-100, 100)
    z = draw(some.arrays(dtype, shape, elements=st.integers(low, high)))
    known = draw(some.arrays(bool, shape))
    known[draw(st.integers(0, shape[0] - 1)), draw(st.integers(0, shape[1] - 1))] = True
    layout = draw(st.sampled_from(["C", "F", "reversed", "strided"]))
    if layout == "strided":
        wide = np.zeros((2 * shape[0], 3 * shape[1]), dtype)
        wide[::2, ::3] = z
        return wide[::2, ::3], known
    return (np.asfortranarray(z) if layout == "F" else z[::-1, ::-1] if layout == "reversed" else z), known


@few
@given(holed_arrays(), st.sampled_from(["spline", "mcmd", "nearest"]))
def test_known_cells_come_back_and_no_hole_is_left(case, method):
    z, known = case
    before = z.copy()
    filled = libdem.fill(z, known, method=method)
    assert np.array_equal(z, before)
    assert filled.elevation.shape == z.shape
    wide = z.dtype.itemsize > 2 and z.dtype.kind != "f" or z.dtype == np.float64
    assert filled.elevation.dtype == (np.float64 if wide else np.float32)
    assert np.array_equal(filled.elevation[known], z[known])
    assert np.isfinite(filled.elevation).all()
    assert np.array_equal(filled.source == libdem.CellOrigin.measured, known)
    assert filled.report["filled"] == np.count_nonzero(~known)


@few
@given(holed_arrays())
def test_nan_mask_nodata_and_known_say_the_same(case):
    z, known = case
    z = z.astype(np.float32)
    by_known = libdem.fill(z, known).elevation
    assert equal_bits(by_known, libdem.fill(np.where(known, z, np.float32(np.nan))).elevation)
    assert equal_bits(by_known, libdem.fill(np.ma.array(z, mask=~known)).elevation)
    assert equal_bits(by_known, libdem.fill(np.where(known, z, np.float32(-9999)), nodata=-9999).elevation)
    assert equal_bits(by_known, libdem.fill(z, known.astype(np.uint8)).elevation)


@few
@given(holed_arrays(), st.sampled_from([1, 2, 3]))
def test_threads_change_no_bit(case, threads):
    z, known = case
    assert equal_bits(libdem.fill(z, known).elevation, libdem.fill(z, known, threads=threads).elevation)


def test_doubles_keep_what_float32_cannot_hold():
    z = np.full((8, 8), 1000.123456789)
    z[3, 3] = np.nan
    filled = libdem.fill(z)
    known = ~np.isnan(z)
    assert equal_bits(filled.elevation[known], z[known])


def test_results_are_views_and_live_on(hills):
    hills[3:6, 3:6] = np.nan
    filled = libdem.fill(hills)
    assert filled.elevation.base is not None and np.shares_memory(filled.elevation, filled.elevation)
    elevation = filled.elevation
    del filled
    assert np.isfinite(elevation).all()
    dem = libdem.Dem(hills)
    dem.z[0, 0] = 77
    assert dem.z[0, 0] == 77 and hills[0, 0] != 77


def test_a_dem_is_not_changed_by_fill(holed):
    before = holed.z.copy(), holed.known.copy()
    libdem.fill(holed, method="nearest")
    assert np.array_equal(holed.z, before[0]) and np.array_equal(holed.known, before[1])


def test_read_only_arrays_are_taken(hills):
    hills[5, 5] = np.nan
    hills.flags.writeable = False
    assert np.isfinite(libdem.fill(hills).elevation).all()


def test_undeclared_no_data_is_warned_of(hills):
    z = hills.astype(np.int16)
    z[4:7, 4:7] = -32768
    with pytest.warns(UserWarning, match='the first -32768 at row 4, column 4; if they mean "unknown"'):
        libdem.fill(z)


@pytest.mark.parametrize("z, keywords, message", [
    (np.zeros(5), {}, "z has 1 dimension; must have 2, rows and columns"),
    (np.zeros((2, 2, 2)), {}, "z has 3 dimensions; must have 2"),
    (np.zeros((0, 4)), {}, "z is empty; must have at least one value"),
    (np.full((3, 3), np.nan), {}, "no cell of z is known; at least one is needed to fill the others"),
    (np.ma.masked_all((3, 3)), {}, "no cell of z is known"),
    (np.zeros((3, 3), complex), {}, "z has dtype complex128; must be float32, float64 or an integer"),
    (np.array([["a"]]), {}, "z has dtype <U1; must be"),
    ([[1, None]], {}, "z has dtype object; must be"),
    (np.full((3, 3), 1e300), {}, "z = 1e[+]300 at row 0, column 0; must be a height within float32, or unknown"),
    (np.zeros((3, 3)), {"known": np.ones((2, 3), bool)}, r"known has shape \(2, 3\); must be \(3, 3\), as z"),
    (np.zeros((3, 3)), {"known": np.ones(3, bool)}, "known has 1 dimension; must have 2"),
    (np.zeros((3, 3)), {"known": np.ones((3, 3))}, "known has dtype float64; must be bool or uint8"),
    (np.array([[1, np.nan]]), {"known": [[True, True]]}, "known is true at row 0, column 1, but z is nan there"),
    (np.zeros((3, 3)), {"method": "splin"}, 'unknown method "splin"; must be one of mcmd, spline'),
    (np.zeros((3, 3)), {"curl": 1}, 'unknown setting "curl"; must be one of parameters'),
    (np.zeros((3, 3)), {"nugget": -1}, r"nugget = -1; must be a number"),
    (np.zeros((3, 3)), {"max_iterations": 1.5}, "max_iterations = 1.5; must be a whole number"),
    (np.zeros((3, 3)), {"seed": [1]}, r"seed = \[1\]; must be a number, a string or a boolean"),
    (np.zeros((3, 3)), {"method": "mcmd", "sigma": True}, 'unknown setting "sigma"'),
    (np.zeros((3, 3)), {"spacing": (1, 0)}, r"spacing = \(1, 0\); must be two lengths in metres above 0"),
    (np.zeros((3, 3)), {"spacing": "wide"}, "spacing = 'wide'; must be one length or two"),
    (np.zeros((3, 3)), {"to_world": (0, 1)}, r"to_world = \(0, 1\); must be six numbers"),
    (np.zeros((3, 3)), {"crs": "EPSG:1", "to_world": (0, 1, 0, 0, 0, -1)}, "crs = EPSG:1; must be"),
    (np.zeros((3, 3)), {"where": "area <"}, "where = area <; must have a number"),
    (np.zeros((3, 3)), {"threads": -1}, "threads = -1; must be a whole number from 0 up"),
    (np.zeros((3, 3)), {"progress": 3}, "progress = 3; must be None, True, a function"),
])
def test_bad_input_is_told_in_one_line(z, keywords, message):
    with pytest.raises(ValueError, match=message) as error:
        libdem.fill(z, **keywords)
    assert "\n" not in str(error.value)


def test_arguments_of_a_wrong_type_are_told_in_one_line(hills):
    with pytest.raises(TypeError, match="fill: an argument has a wrong type; expected .*whole: bool") as error:
        libdem.fill(hills, whole="x")
    assert "\n" not in str(error.value)


def test_other_calls_tell_what_is_wrong(hills, tmp_path):
    for call, message in [
            (lambda: libdem.sample(hills), "exactly one of keep, count.* is needed; 0 were given"),
            (lambda: libdem.sample(hills, keep=2), r"keep = 2; must be in \(0, 1\]"),
            (lambda: libdem.sample(hills, every=1.5), "every = 1.5; must be a whole number above 0"),
            (lambda: libdem.evaluate(hills, hills[1:]), r"got has shape \(39, 50\); must be \(40, 50\), as truth"),
            (lambda: libdem.evaluate(hills, hills, hills), "sampled knows every cell"),
            (lambda: libdem.grid([1, 2], [1], [1, 2]), "y has 1 values; must have 2, as z"),
            (lambda: libdem.grid([np.nan], [1], [1]), "no point has a finite x, y and z"),
            (lambda: libdem.grid([1], [1], [1], bounds=(0, 0, 9, 9)), "bounds needs cell"),
            (lambda: libdem.grid([1], [1], [1], bounds=(0, 0, 9), cell=1), "must be west, south, east, north"),
            (lambda: libdem.grid(), "x, y and z, the path of a file, or contours are needed"),
            (lambda: libdem.grid("p.csv", [1], [1]), "leave out the arrays"),
            (lambda: libdem.grid([1], [1], [1], contours="c.gpkg"), "together with contour lines"),
            (lambda: libdem.grid(contours=[[1, 2]], cell=1), r"contours.*of shape \(n, 2\)"),
            (lambda: libdem.grid(contours=[(1, [[1, 2], [5, 9]])]), "contours needs cell"),
            (lambda: libdem.grid([1, 9], [1, 9], [1, 2], cell=1, breaklines=[[5, 5]]), r"of shape \(n, 2\)"),
            (lambda: libdem.grid([1, 9], [1, 9], [1, 2], cell=1, breaklines=[[[50, 5], [60, 9]]]),
             "none of its lines passes between two cells"),
            (lambda: libdem.grid([1], [1], [1], like=hills, cell=3), "like says it all"),
            (lambda: libdem.grid([1], [1], [1], crs="nonsense"), "crs = nonsense; must be a coordinate system"),
            (lambda: libdem.supersample(hills, 1), "factor = 1; must be a number in"),
            (lambda: libdem.generate("nois"), 'unknown generator "nois"'),
            (lambda: libdem.generate("noise", 0), "rows = 0; must be a whole number from 1 up"),
            (lambda: libdem.generate("sketch"), "sketch needs an image"),
            (lambda: libdem.generate("noise", 9, image=hills), "noise starts from no image"),
            (lambda: libdem.erode(hills, stepz=5), 'unknown setting "stepz"'),
            (lambda: libdem.render(hills, "pretty"), "style = pretty; must be relief, hillshade or view"),
            (lambda: libdem.fill(libdem.Dem(hills), spacing=3), "spacing is for arrays; a Dem has its own")]:
        with pytest.raises(ValueError, match=message):
            call()
    libdem.write(tmp_path / "there.tif", hills)
    for call, message in [(lambda: libdem.read(tmp_path / "none.tif"), "none.tif: No such file"),
                          (lambda: libdem.grid(tmp_path / "none.csv"), "none.csv"),
                          (lambda: libdem.write(tmp_path / "there.tif", hills), "overwrite=True replaces it"),
                          (lambda: libdem.write(tmp_path / "no" / "a.tif", hills), "its folder .* does not exist")]:
        with pytest.raises(OSError, match=message):
            call()
