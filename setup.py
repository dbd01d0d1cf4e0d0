"""Builds the Python package by CMake, with what is installed: nothing is downloaded.

    pip install --no-build-isolation .

CMAKE_ARGS goes to cmake; DEM_BUILD names a CMake build folder to take instead of building anew.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).parent.resolve()
VERSION = re.search(r"project\(libdem VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        given = os.environ.get("DEM_BUILD")  # a build that is there already
        build = pathlib.Path(given or self.build_temp).resolve()
        if not given:
            build.mkdir(parents=True, exist_ok=True)
            generator = ["-G", "Ninja"] if shutil.which("ninja") else []
            subprocess.check_call(["cmake", "-S", ROOT, "-B", build, *generator, "-DCMAKE_BUILD_TYPE=Release",
                                   "-DDEM_BUILD_TESTS=OFF", "-DDEM_BUILD_BENCH=OFF", f"-DDEM_PYTHON={sys.executable}",
                                   *shlex.split(os.environ.get("CMAKE_ARGS", ""))])
        subprocess.check_call(["cmake", "--build", build, "--target", "dem_python_package", "--parallel"])
        package = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve().parent
        package.mkdir(parents=True, exist_ok=True)
        for file in (build / "apps/python/libdem").iterdir():
            if file.suffix in {".so", ".pyi"}:
                shutil.copy2(file, package)


(ROOT / "build").mkdir(exist_ok=True)
setup(
    name="libdem",
    version=VERSION,
    description="Reconstruction of digital elevation models",
    python_requires=">=3.9",
    install_requires=["numpy"],
    extras_require={"xarray": ["xarray", "rioxarray"], "distributed": ["distributed"], "progress": ["tqdm"]},
    packages=["libdem"],
    package_dir={"libdem": "apps/python/libdem"},
    package_data={"libdem": ["py.typed"]},
    ext_modules=[Extension("libdem._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    options={"egg_info": {"egg_base": "build"}},
    zip_safe=False,
)
