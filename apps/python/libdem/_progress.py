"""Progress of long calls."""

import contextlib
import sys


class ProgressBar:
    """A progress callback that draws a tqdm bar: `libdem.fill(z, progress=libdem.ProgressBar())`.

    `bar` is a tqdm object of your own (its total is set to 1), or None for a new one; keywords go to
    tqdm. It can be used for one call after another, and is closed by `close()` or `with`.
    """

    def __init__(self, bar=None, **options):
        if bar is None:
            from tqdm.auto import tqdm
            shape = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
            bar = tqdm(**{"total": 1.0, "bar_format": shape, **options})
        bar.total = 1.0
        self.bar = bar

    def __call__(self, part, what):
        if part < self.bar.n:
            self.bar.reset()
        self.bar.set_description_str(what, refresh=False)
        self.bar.update(part - self.bar.n)

    def close(self):
        self.bar.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class _Line:
    """A line of text that is written again and again, where there is no tqdm."""

    def __call__(self, part, what):
        print(f"\r{what}: {100 * part:3.0f} %", end="", file=sys.stderr, flush=True)

    def close(self):
        print(file=sys.stderr)


@contextlib.contextmanager
def callback(progress):
    """What the module calls, from what a user gives: None, True, a function, or a tqdm bar."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        try:
            own = ProgressBar()
        except ImportError:
            own = _Line()
        try:
            yield own
            own(1.0, "done")
        finally:
            own.close()
    elif callable(progress):
        yield progress
    elif hasattr(progress, "update") and hasattr(progress, "total"):
        yield ProgressBar(progress)
    else:
        raise ValueError(f"progress = {progress!r}; must be None, True, a function of (part, what), or a tqdm bar")
