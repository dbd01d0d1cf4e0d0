#!/usr/bin/env python3
"""Runs the shell blocks of a page, in order and in one folder, and compares what they print with the page.

    scripts/run_page.py PAGE DEM            exit code 1 when a block fails or prints something else
    scripts/run_page.py PAGE DEM --update   writes what they print into the page

A block ```sh is a command; a block ```text right after it is its output. Times differ from run to run: numbers before
" s" or " ms" are not compared. Beside the folder lies testdata/.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"```sh\n(?P<command>.*?)```\n(?:```text\n(?P<output>.*?)```\n)?", re.DOTALL)
TIME = re.compile(r"\d+(\.\d+)? (m?s)\b")


def comparable(text):
    return TIME.sub(r"? \2", text)


def main():
    page, dem = pathlib.Path(sys.argv[1]), os.path.abspath(sys.argv[2])
    update = sys.argv[3:] == ["--update"]
    text, faults = page.read_text(encoding="utf-8"), []
    with tempfile.TemporaryDirectory(prefix="dem-page-") as folder:
        work = pathlib.Path(folder) / "work"
        work.mkdir()
        (work.parent / "testdata").symlink_to(pathlib.Path(__file__).resolve().parents[1] / "testdata")
        path = f"{os.path.dirname(dem)}:{os.environ['PATH']}"

        def run(match):
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", match["command"]], cwd=work, text=True,
                                  timeout=120, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  env={**os.environ, "PATH": path, "LC_ALL": "C.UTF-8"})
            if done.returncode != 0:
                faults.append(f"this fails:\n{match['command']}{done.stdout}")
            elif comparable(done.stdout) != comparable(match["output"] or ""):
                faults.append(f"this prints something else:\n{match['command']}{done.stdout}")
            else:
                return match[0]  # times stay as they are
            shown = f"```text\n{done.stdout}```\n" if done.stdout else ""
            return f"```sh\n{match['command']}```\n{shown}"

        new = BLOCK.sub(run, text)
    if update:
        faults = [fault for fault in faults if fault.startswith("this fails")]
        page.write_text(new, encoding="utf-8")
    if faults:
        sys.exit(f"{page}: " + f"\n{page}: ".join(faults))
    print(f"{page}: {len(BLOCK.findall(text))} blocks run as the page says")


if __name__ == "__main__":
    main()
