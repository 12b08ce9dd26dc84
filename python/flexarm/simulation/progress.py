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
    with bar(keep=True) as tell:
        yield lambda done: tell(done, name)
        tell(1.0, name)


@contextmanager
def bar(keep: bool = False) -> Iterator[Callable[[float, str], None]]:
    """A bar on standard error, told how much is done, 0 to 1, and what is; kept at the end or not."""
    from shutil import get_terminal_size

    from tqdm import tqdm

    columns, rows = get_terminal_size()  # tqdm draws nothing at a terminal that tells no size
    form = "{desc:<22}{percentage:3.0f} %|{bar}| {elapsed}"
    with tqdm(total=100, bar_format=form, leave=keep, ncols=columns, nrows=rows) as drawn:

        def tell(done: float, what: str) -> None:
            drawn.set_description_str(what, refresh=False)
            drawn.n = round(100 * done)
            drawn.refresh()

        yield tell
