"""What is made from the parser: completion in three shells, manual pages, tables for programs."""

import functools
import json
import os
import re
import shutil
import subprocess
import unittest

from support import DEM, CliTest, main, slow


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"{program} is not installed: apt-get install {program}")


@functools.cache
def output(*arguments):
    return subprocess.run([DEM, *arguments], capture_output=True, text=True, check=True, timeout=60).stdout


class Verbs(CliTest):
    def setUp(self):
        super().setUp()
        self.tables = json.loads(output("methods", "--json"))
        self.verbs = {verb["name"]: verb for verb in self.tables["verbs"]}

    def test_table_of_verbs_is_the_help(self):
        for name, verb in self.verbs.items():
            text = output(name, "--help")
            listed = set(re.findall(r"--[a-z][a-z0-9-]*", text.split("Examples:")[0].split("Options:")[1]))
            options = {o["names"][-1] for o in verb["options"]}
            self.assertLessEqual(options, listed, name)
            rows = {w for line in text.split("Examples:")[0].splitlines() if line.startswith("  -")
                    for w in re.findall(r"^  (?:-\w,)?(--[a-z0-9-]+)", line)}
            self.assertEqual(options, rows - {"--help"}, name)

    def test_marks_tell_what_options_take(self):
        options = {o["names"][-1]: o for o in self.verbs["fill"]["options"]}
        self.assertIn("mcmd:paper", options["--method"]["choices"])
        self.assertEqual(options["--sigma"]["takes"], "new raster")
        self.assertEqual(options["--water"]["takes"], "vector")
        self.assertEqual(options["--method"]["default"], "spline")
        self.assertTrue(options["--aux"]["repeats"])
        self.assertEqual([a["names"] for a in self.verbs["fill"]["arguments"]], [["IN"], ["OUT"]])
        self.assertEqual({o["names"][-1]: o for o in self.verbs["erode"]["options"]}["--water"]["takes"], "new raster")

    def test_every_file_of_a_verb_is_marked(self):
        for name, verb in self.verbs.items():
            for a in verb["arguments"] + verb["options"]:
                looks = (re.search(r"FILE|DEM|RASTER|LAYER|DIR|SAMPLED", a["value"]) or
                         a["names"][0] in ("IN", "OUT", "TRUTH", "GOT", "DIR", "FILE", "FILES", "POINTS"))
                self.assertEqual(bool(looks), a["takes"] not in ("", "number", "crs"), (name, a["names"]))

    def test_table_has_settings_of_erosion_and_styles(self):
        self.assertIn("steps", [f["name"] for f in self.tables["erosion"]])
        self.assertIn("multidirectional", [f["name"] for f in self.tables["styles"]["hillshade"]])

    def test_one_method_comes_without_the_verbs(self):
        self.assertEqual(set(json.loads(self.succeeds("methods", "mcmd", "--json").stdout)), {"fill", "generators"})

    def test_every_verb_has_a_page(self):
        for name, verb in self.verbs.items():
            page = output("manual", name)
            self.assertTrue(page.startswith(f".TH DEM\\-{name.upper()} 1"), page[:60])
            for option in verb["options"]:
                self.assertIn(option["names"][-1].replace("-", "\\-"), page)
            self.assertIn(f"# dem {name}\n", output("manual", name, "--format", "markdown"))
        self.assertIn("dem\\-fill (1)", output("manual"))

    @slow
    @needs("man")
    def test_man_reads_the_pages_without_complaint(self):
        pages = [self.write(f"{name or 'dem'}.1", output("manual", *filter(None, [name])))
                 for name in ["", *self.verbs]]
        read = subprocess.run(["man", "--warnings", "-l", *pages], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "MANWIDTH": "100", "MANROFFSEQ": "", "LC_ALL": "C.UTF-8"})
        self.assertEqual((read.returncode, read.stderr), (0, ""))
        self.assertEqual(read.stdout.count("SYNOPSIS"), len(pages))

    def test_wrong_verb_shell_and_format_are_refused(self):
        self.fails(1, "manual", "fil", says=["fil", "fill", "grid"])
        self.fails(1, "completion", "tcsh", says=["tcsh", "bash"])
        self.fails(1, "manual", "fill", "--format", "pdf", says=["pdf", "markdown"])


@slow
class Completion(CliTest):
    """What a shell offers at the end of a line."""

    def bash(self, line):
        program = ('source <("$DEM_BINARY" completion bash); COMP_LINE=$1; COMP_POINT=${#1}; '
                   'COMP_WORDBREAKS=$\' \\t\\n"\\\'><=;|&(:\'; _dem; printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run(["bash", "-c", program, "bash", line], capture_output=True, text=True, cwd=self.dir,
                              env={**os.environ, "DEM_BINARY": DEM}, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.split()

    def fish(self, line):
        script = self.write("dem.fish", output("completion", "fish"))
        path = f"{os.path.dirname(DEM)}:{os.environ['PATH']}"
        done = subprocess.run(["fish", "--no-config", "-c", f"source {script}; complete -C '{line}'"], cwd=self.dir,
                              capture_output=True, text=True, timeout=60,
                              env={**os.environ, "HOME": self.dir, "PATH": path})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return [entry.split("\t")[0] for entry in done.stdout.splitlines()]

    def zsh(self, line):
        """In a terminal of its own: types the line, presses Tab, and reads what is listed."""
        self.write("_dem", output("completion", "zsh"))
        self.write("ask.zsh", """
zmodload zsh/zpty
zpty z zsh -f -i
ask() { zpty -w z "$1"; }
ask "stty columns 200; PS1=; fpath=($PWD \\$fpath); autoload -Uz compinit; compinit -u -d $PWD/dump"
ask "zstyle ':completion:*' list-prompt ''; LISTMAX=10000; zstyle ':completion:*' verbose no"
ask "bindkey '^I' list-choices"
ask "print rea''dy"
zpty -r -m z answer '*ready*' || exit 1
zpty -w -n z "$1"$'\\t'
sleep 1  # a key that waits would stop the listing
ask $'\\025print do''ne'
zpty -r -m z answer '*done*' || exit 1
print -r -- "$answer"
zpty -d z
""")
        done = subprocess.run(["zsh", "-f", "ask.zsh", line], capture_output=True, text=True, cwd=self.dir,
                              timeout=60, env={**os.environ, "HOME": self.dir, "TERM": "dumb"})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout.split()

    def offers_the_same(self, complete):
        self.write("a.tif", "")
        self.assertIn("supersample", complete("dem "))
        self.assertNotIn("fill", complete("dem su"))
        self.assertIn("--sigma", complete("dem fill --s"))
        self.assertNotIn("--factor", complete("dem fill --"))
        self.assertIn("hillshade", complete("dem render a.tif b.png --style "))
        self.assertIn("noise", complete("dem generate "))
        self.assertIn("mcmd", complete("dem fill a.tif b.tif --method "))

    def test_bash_offers_verbs_options_and_names(self):
        self.offers_the_same(self.bash)
        self.assertEqual(self.bash("dem fill a.tif b.tif --method mcmd:"), ["paper"])  # after bash's own word break
        self.assertEqual(self.bash("dem fill a"), [])  # left to the shell: files

    @needs("fish")
    def test_fish_offers_verbs_options_and_names(self):
        self.offers_the_same(self.fish)
        self.assertIn("mcmd:paper", self.fish("dem fill a.tif b.tif --method mcmd:"))
        self.assertIn("a.tif", self.fish("dem fill a"))

    @needs("zsh")
    def test_zsh_offers_verbs_options_and_names(self):
        self.offers_the_same(self.zsh)


if __name__ == "__main__":
    main()
