"""OpenImageIO is loaded by what reads or draws images, and by nothing else."""

import os
import pathlib
import shutil
import unittest

from support import CliTest, main

LIBRARY = "libOpenImageIO"


class ImageModule(CliTest):
    def loaded(self, *arguments):
        """Whether a run that succeeds loads OpenImageIO, by the messages of the dynamic linker."""
        self.succeeds(*arguments, env={"LD_DEBUG": "files", "LD_DEBUG_OUTPUT": self.path("linker")})
        messages = "".join(file.read_text() for file in pathlib.Path(self.dir).glob("linker.*"))
        self.assertIn("libgdal", messages)
        return LIBRARY in messages

    def test_is_not_loaded_without_an_image(self):
        tile = self.holed()
        for arguments in (["--version"], ["fill", "--help"], ["info", tile], ["fill", tile, "filled.tif"]):
            with self.subTest(arguments=arguments):
                self.assertFalse(self.loaded(*arguments))

    def test_is_loaded_to_draw_to_write_an_image_and_to_fill_by_its_method(self):
        tile = self.holed()
        for arguments in (["render", tile, "shade.png"], ["fill", tile, "filled.png"],
                          ["fill", tile, "filled.tif", "--method", "pushpull"]):
            with self.subTest(arguments=arguments):
                self.assertTrue(self.loaded(*arguments))

    def test_missing_module_is_one_line_that_names_the_package(self):
        tile = self.holed()
        os.mkdir(self.path("empty"))
        before = sorted(os.listdir(self.dir))
        says = ["libdem-images.so: ", "is not in empty", "install the package libdem", "DEM_MODULES"]
        for arguments in (["render", tile, "shade.png"], ["fill", tile, "filled.png"], ["info", self.image()],
                          ["fill", tile, "filled.tif", "--method", "pushpull"]):
            with self.subTest(arguments=arguments):
                done = self.dem(*arguments, env={"DEM_MODULES": "empty"})
                self.assertNotEqual(done.returncode, 0)
                self.assert_one_error_line(done.stderr, says)
        self.assertEqual(sorted(os.listdir(self.dir)), sorted([*before, "image.png"]))
        self.succeeds("fill", tile, "filled.tif", env={"DEM_MODULES": "empty"})

    def image(self):
        self.succeeds("fill", "N10E010.hgt", "image.png")
        return "image.png"

    def test_module_that_does_not_load_is_one_line_that_names_openimageio(self):
        self.write("libdem-images.so", "not a library")
        self.fails(2, "render", self.holed(), "shade.png", env={"DEM_MODULES": self.dir},
                   says=["libdem-images.so: cannot be loaded", "file too short", "libopenimageio"])

    @unittest.skipUnless(shutil.which("cc"), "needs a C compiler")
    def test_module_of_another_version_is_one_line_that_says_so(self):
        source = self.write("other.c", "int nothing;\n")
        os.system(f"cc -shared -o {self.path('libdem-images.so')} {source}")
        self.fails(2, "render", self.holed(), "shade.png", env={"DEM_MODULES": self.dir},
                   says=["libdem-images.so: is the module of another version of libdem"])


if __name__ == "__main__":
    main()
