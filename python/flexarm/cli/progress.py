"""Progress of long work on standard error: a bar at a terminal, elsewhere a line now and then.

A command that prints JSON tells its progress to a terminal alone.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

Tell = Callable[[float, str], None]
"""The part that is done, 0 to 1, and what is being done."""
SECONDS = 10.0
"""Between two lines, and before the first: a log stays short, and short work prints none."""


@contextmanager
def progress(json: bool = False) -> Iterator[Tell]:
    """Yield a function that tells how much is done and what is being done; `json` as the command's option."""
    if not sys.stderr.isatty():
        yield (lambda done, what: None) if json else lines()
        return
    from flexarm.simulation.progress import bar

    with bar() as tell:
        yield tell


def lines() -> Tell:
    """Return a function that prints a line of progress at most every ten seconds."""
    began = told = monotonic()

    def tell(done: float, what: str) -> None:
        nonlocal told
        now = monotonic()
        if now - told >= SECONDS:
            told = now
            print(f"{what}: {100 * done:.0f} %, {now - began:.0f} s", file=sys.stderr)

    return tell
