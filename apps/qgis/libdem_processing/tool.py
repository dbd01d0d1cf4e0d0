"""The program `dem`: where it is, what it offers, and one run of it. Knows nothing of QGIS."""

import functools
import json
import os
import queue
import shutil
import subprocess
import threading

INTERRUPTED, UNFILLED = 5, 3
MISSING = ("dem was not found{}: install libdem, or set \"Path of dem\" in Settings > Options > Processing > "
           "Providers > libdem")


class DemError(Exception):
    """One line that says what is wrong."""


class Cancelled(DemError):
    """The run was stopped; no output was changed."""


def find(setting=""):
    """The program: as set, else on the path."""
    found = shutil.which(setting or "dem")
    if not found:
        raise DemError(MISSING.format(f" at {setting}" if setting else " on the path"))
    return found


def tables(program):
    """Methods, generators and verbs with their options, as this very program has them."""
    return _tables(program, os.stat(program).st_mtime_ns)


@functools.lru_cache(maxsize=4)
def _tables(program, _modified):
    try:
        done = subprocess.run([program, "methods", "--json"], capture_output=True, timeout=60, **_no_window())
        offered = json.loads(done.stdout)
        offered["verbs"] = {verb["name"]: verb for verb in offered["verbs"]}
        return offered
    except (OSError, ValueError, KeyError, subprocess.TimeoutExpired) as error:
        raise DemError(f"{program} is not the program dem of libdem, or too old: {error!r}") from error


def _no_window():
    return {"creationflags": subprocess.CREATE_NO_WINDOW} if os.name == "nt" else {}


def run(program, arguments, progress=lambda part, what: None, message=lambda text: None, cancelled=lambda: False):
    """Runs `dem ARGUMENTS`; returns what it reports. Progress, messages and the wish to stop pass through."""
    command = [program, *arguments, "--json", "--progress", "json"]
    lines, stdout = queue.Queue(), []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                          text=True, encoding="utf-8", errors="replace", **_no_window()) as process:
        readers = [threading.Thread(target=lambda: [lines.put(line) for line in process.stderr], daemon=True),
                   threading.Thread(target=lambda: stdout.append(process.stdout.read()), daemon=True)]
        for reader in readers:
            reader.start()
        last, stopping = "", False
        while readers[0].is_alive() or not lines.empty():
            if cancelled() and not stopping:
                stopping = True
                process.terminate()
            try:
                last = _take(lines.get(timeout=0.1), progress, message) or last
            except queue.Empty:
                pass
        readers[1].join()
        process.wait()
    if stopping or process.returncode == INTERRUPTED:
        raise Cancelled("stopped; no output was changed")
    if process.returncode not in (0, UNFILLED):
        raise DemError(last or f"dem ended with code {process.returncode}")
    return {"exit_code": process.returncode, **json.loads("".join(stdout) or "{}")}


def _take(line, progress, message):
    """Passes one line of stderr on; returns it when it is an error's."""
    line = line.strip()
    if line.startswith('{"part"'):
        report = json.loads(line)
        progress(report["part"], report["what"])
        return ""
    if line.startswith("dem: "):
        return line[len("dem: "):]
    if line:
        message(line)
    return ""
