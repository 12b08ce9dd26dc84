"""Several things at once, in threads: simulations let go of the interpreter."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from flexarm.threads import thread_pool

Given = TypeVar("Given")
Found = TypeVar("Found")


def at_once(do: Callable[[Given], Found], things: Iterable[Given], jobs: int) -> list[Found]:
    """What is done to each, in their order, `jobs` at once."""
    given = list(things)
    if jobs == 1 or len(given) < 2:
        return list(map(do, given))
    with thread_pool(min(jobs, len(given))) as pool:
        return list(pool.map(do, given))
