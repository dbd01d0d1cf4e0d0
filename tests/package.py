"""The Debian package: made by cpack, unpacked into a folder, and used from there."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1]).resolve()
TILE = pathlib.Path(__file__).resolve().parents[1] / "testdata" / "jacksboro.tif"


def output(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, **options)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dem-package-"))
        output("cpack", "-G", "DEB", "-B", cls.folder / "made", cwd=BUILD)
        (cls.package,) = (cls.folder / "made").glob("*.deb")
        cls.root = cls.folder / "root"
        output("dpkg", "-x", cls.package, cls.root)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_program_runs_from_the_folder(self):
        dem = self.root / "usr/bin/dem"
        sparse, filled = self.folder / "sparse.tif", self.folder / "filled.tif"
        output(dem, "sample", TILE, sparse, "--keep", "20%")
        output(dem, "fill", sparse, filled)
        output(dem, "evaluate", TILE, filled, "--known", sparse, "--expect", "rmse<20")

    def test_program_draws_by_the_module_in_the_package(self):
        output(self.root / "usr/bin/dem", "render", TILE, self.folder / "shade.png")

    def test_depends_on_the_libraries_that_the_program_links(self):
        depends = output("dpkg-deb", "--field", self.package, "Depends")
        for library in ("libc6", "libgdal", "libtbb", "libgeographic", "libopenimageio", "libfmt"):
            self.assertIn(library, depends)

    def test_holds_manual_completion_library_and_licence(self):
        for path in ("usr/share/man/man1/dem.1.gz", "usr/share/man/man1/dem-fill.1.gz",
                     "usr/share/bash-completion/completions/dem", "usr/share/zsh/vendor-completions/_dem",
                     "usr/share/fish/vendor_completions.d/dem.fish", "usr/include/libdem.h",
                     "usr/lib/pkgconfig/dem.pc", "usr/lib/cmake/libdem/libdem-config.cmake",
                     "usr/share/doc/libdem/copyright"):
            self.assertTrue((self.root / path).exists(), path)
        outside = [p for p in self.root.iterdir() if p.name != "usr"]
        self.assertEqual(outside, [])

    @unittest.skipUnless(os.geteuid() == 0, "dpkg --install wants root, even to try")
    def test_dpkg_would_install_it(self):
        output("dpkg", "--dry-run", "--install", self.package)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
