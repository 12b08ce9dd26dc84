"""How far a long computation is: a bar at the terminal, or a function of the caller's own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = bool | Callable[[float], object] | None
"""What a caller may give: True for a bar, or what gets the share done and may return False to stop."""
Report = Callable[[float], object] | None
"""What the core is given."""


@contextmanager
def reported(progress: Progress, name: str) -> Iterator[Report]:
    """The callback for the core: a bar, the caller's own, or none."""
    if progress is None or progress is False or callable(progress):
        yield progress if callable(progress) else None
        return
    from shutil import get_terminal_size

    from tqdm import tqdm

    columns, rows = get_terminal_size()  # tqdm draws nothing at a terminal that tells no size
    form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
    with tqdm(total=100, desc=name, bar_format=form, ncols=columns, nrows=rows) as bar:

        def show(done: float) -> None:
            bar.update(100 * done - bar.n)

        yield show
        bar.update(100 - bar.n)
