"""Progress of a work in phases: a bar on standard error, for a person at a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from shutil import get_terminal_size


@contextmanager
def phases(shown: bool) -> Iterator[Callable[[str, float], None] | None]:
    """A function that takes the phase and the part of it that is done, 0 to 1; None if nothing is shown."""
    if not shown:
        yield None
        return
    from tqdm import tqdm

    columns, rows = get_terminal_size()  # tqdm draws nothing at a terminal that tells no size
    form = "{desc:<22}{percentage:3.0f} %|{bar}| {elapsed}"
    with tqdm(total=100, bar_format=form, leave=False, ncols=columns, nrows=rows) as bar:

        def tell(phase: str, done: float) -> None:
            bar.set_description_str(phase, refresh=False)
            bar.n = round(100 * done)
            bar.refresh()

        yield tell
