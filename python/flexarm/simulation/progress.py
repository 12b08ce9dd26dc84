"""Progress of a long computation: a bar at the terminal, or a function of the caller."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from shutil import get_terminal_size

Progress = bool | Callable[[float], object] | None
"""True for a bar, or a function that gets the share done and may return False to stop."""
Report = Callable[[float], object] | None
"""Callback of the core."""


@contextmanager
def reported(progress: Progress, name: str) -> Iterator[Report]:
    """Yield the callback for the core: a bar, the caller's own, or none."""
    if progress is None or progress is False or callable(progress):
        yield progress if callable(progress) else None
        return
    with bar(keep=True) as tell:
        yield lambda done: tell(done, name)
        tell(1.0, name)


@contextmanager
def bar(keep: bool = False) -> Iterator[Callable[[float, str], None]]:
    """Yield a function of the share done, 0 to 1, and its name, that draws a bar on standard error."""
    from tqdm import tqdm

    columns, rows = get_terminal_size()  # tqdm draws nothing at a terminal that tells no size
    form = "{desc:<22}{percentage:3.0f} %|{bar}| {elapsed}"
    with tqdm(total=100, bar_format=form, leave=keep, ncols=columns, nrows=rows) as drawn:

        def tell(done: float, what: str) -> None:
            drawn.set_description_str(what, refresh=False)
            drawn.n = round(100 * done)
            drawn.refresh()

        yield tell
