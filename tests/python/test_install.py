"""pip installs the package without a network."""

import os
import pathlib
import subprocess
import sys

import pytest

pytest.importorskip("pip", reason="python3-pip is missing")
ROOT = pathlib.Path(__file__).parents[2]


def test_pip_installs_what_can_be_imported(tmp_path):
    command = [sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "--quiet",
               "--target", tmp_path / "site", ROOT]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    code = ("import libdem, libdem.distributed, numpy as np; z = np.zeros((9, 9)); z[3, 3] = np.nan;"
            "libdem.fill(z, method='pushpull');"  # by the module that is installed beside the package's own
            "print(libdem.__version__, libdem.fill(z).elevation[3, 3], libdem.__file__)")
    assert (tmp_path / "site" / "libdem" / "libdem-images.so").exists()
    env = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    version, filled, file = subprocess.run([sys.executable, "-c", code], env=env, cwd=tmp_path, capture_output=True,
                                           text=True, check=True).stdout.split()
    assert float(filled) == 0
    assert file.startswith(str(tmp_path))
    assert f"VERSION {version} " in (ROOT / "CMakeLists.txt").read_text()
    assert (tmp_path / "site" / "libdem" / "__init__.pyi").exists()
