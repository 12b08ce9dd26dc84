"""Progress of long work on standard error: a bar at a terminal, elsewhere a line now and then.

A command that prints JSON tells its progress to a terminal alone. A thread shows the last state again, with
the time that has passed, while the work itself is silent.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread
from time import monotonic

Tell = Callable[[float, str], None]
"""The part that is done, 0 to 1, and what is being done."""
SECONDS = 10.0
"""Between two lines, and before the first: a log stays short, and short work prints none."""
AGAIN = 1.0
"""Seconds after which a silent state is shown again."""


@contextmanager
def progress(json: bool = False) -> Iterator[Tell]:
    """Yield a function that tells how much is done and what is being done; `json` as the command's option."""
    if not sys.stderr.isatty():
        if json:
            yield lambda done, what: None
            return
        with repeated(lines()) as tell:
            yield tell
        return
    from flexarm.simulation.progress import bar

    with bar() as drawn, repeated(drawn) as tell:
        yield tell


@contextmanager
def repeated(show: Tell) -> Iterator[Tell]:
    """Yield a function like `show`, of which a thread shows the last state again until the block ends."""
    last: list[tuple[float, str]] = []
    over, one_at_a_time = Event(), Lock()

    def tell(done: float, what: str) -> None:
        with one_at_a_time:
            last[:] = [(done, what)]
            show(done, what)

    def repeat() -> None:
        while not over.wait(AGAIN):
            with one_at_a_time:
                for state in last:
                    show(*state)

    thread = Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield tell
    finally:
        over.set()
        thread.join()


def lines() -> Tell:
    """Return a function that prints a line of progress at most every ten seconds."""
    began = told = monotonic()

    def tell(done: float, what: str) -> None:
        nonlocal told
        now = monotonic()
        if now - told >= SECONDS:
            told = now
            share = f": {100 * done:.0f} %" if done > 0 else ""
            print(f"{what}{share}, {now - began:.0f} s", file=sys.stderr)

    return tell
