"""Progress, stops, threads of Python, help and stubs."""

import ast
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import libdem


@pytest.fixture(scope="module")
def large():
    rng = np.random.default_rng(1)
    z = rng.normal(500, 50, (1200, 1200)).astype(np.float32)
    z[rng.random(z.shape) < 0.9] = np.nan
    return z


def test_progress_runs_from_0_to_1(large):
    parts = []
    libdem.fill(large, progress=lambda part, what: parts.append((part, what)))
    assert len(parts) > 2
    assert all(0 <= part <= 1 and isinstance(what, str) for part, what in parts)
    assert [part for part, _ in parts] == sorted(part for part, _ in parts)


def test_a_callback_that_says_false_stops(large):
    with pytest.raises(KeyboardInterrupt, match="stopped by the progress callback"):
        libdem.fill(large, progress=lambda part, what: False)


def test_what_a_callback_raises_comes_through(large):
    def fail(part, what):
        raise ZeroDivisionError("mine")
    with pytest.raises(ZeroDivisionError, match="mine"):
        libdem.fill(large, progress=fail)


def test_ctrl_c_stops_a_fill():
    code = ("import numpy as np, libdem\n"
            "z = np.random.default_rng(1).normal(0, 1, (3000, 3000)).astype('f4')\n"
            "z[np.random.default_rng(2).random(z.shape) < 0.9] = np.nan\n"
            "print('go', flush=True)\n"
            "while True: libdem.fill(z)\n")
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "go\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    _, error = child.communicate(timeout=30)
    assert child.returncode != 0 and error.rstrip().endswith("KeyboardInterrupt"), error


def test_python_goes_on_while_a_fill_works(large):
    """Another thread counts while the fill runs; it could not if the lock were held."""
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)
    thread = threading.Thread(target=count)
    thread.start()
    libdem.fill(large, threads=1)
    done.set()
    thread.join()
    assert counted[0] > 5


def test_fills_side_by_side_give_the_same(large):
    part = large[:300, :300]
    alone = libdem.fill(part).elevation
    results = [None] * 4

    def work(i):
        results[i] = libdem.fill(part).elevation
    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(np.array_equal(alone, r) for r in results)


def test_tqdm_bars(large, capsys):
    tqdm = pytest.importorskip("tqdm", reason="python3-tqdm is missing")
    part = large[:400, :400]
    libdem.fill(part, progress=True)
    assert "100%" in capsys.readouterr().err
    with tqdm.tqdm() as bar:
        libdem.fill(part, progress=bar)
        assert bar.total == 1.0
    with libdem.ProgressBar(desc="mine", file=open(os.devnull, "w")) as bar:
        libdem.fill(part, progress=bar)
        libdem.fill(part, progress=bar)


def test_help_tells_every_setting():
    for method in libdem.methods().values():
        for field in method.fields:
            assert f"{field.name} = {field.default!r}" in libdem.fill.__doc__
            assert field.doc in libdem.fill.__doc__.replace("\n        ", " ") or field.doc in libdem.fill.__doc__
    for generator in libdem.generators().values():
        assert generator.summary in libdem.generate.__doc__
    for name in libdem.__all__:
        assert getattr(libdem, name).__doc__, name


def test_stubs_have_every_public_name_and_setting():
    path = pathlib.Path(libdem.__file__).with_name("__init__.pyi")
    tree = ast.parse(path.read_text())
    names = {node.name for node in tree.body if hasattr(node, "name")}
    assert set(libdem.__all__) <= names
    fills = [node for node in tree.body if getattr(node, "name", "") == "fill"]
    assert len(fills) == len(libdem.methods()) + 1  # and one for any other name
    for node in fills[:-1]:
        arguments = {a.arg for a in node.args.kwonlyargs}
        method = next(a for a in node.args.kwonlyargs if a.arg == "method")
        name = ast.literal_eval(method.annotation.slice if isinstance(method.annotation.slice, ast.Constant)
                                else method.annotation.slice.elts[0])
        assert {f.name for f in libdem.methods()[name].fields} <= arguments
