"""Parallel runs in threads, since simulations release the interpreter; forks wait for imports of threads."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from importlib import _bootstrap
from typing import TypeVar


@contextmanager
def thread_pool(threads: int) -> Iterator[ThreadPoolExecutor]:
    """Yield a pool of so many threads, which import what they need.

    What has not begun at the end, as after an interrupt, is dropped.
    """
    _let_forks_wait()
    pool = ThreadPoolExecutor(threads)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


@cache
def _let_forks_wait() -> None:
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=_wait_for_imports)


def _wait_for_imports() -> None:
    """Wait until no other thread imports a module.

    Its lock would go along into the forked process, where no thread is left to free it, and the next import
    of the module would wait for ever.
    """
    patience = 10.0  # how long a fork waits for modules to be imported [s]
    until = time.monotonic() + patience
    while _others_import() and time.monotonic() < until:
        time.sleep(0.001)


def _others_import() -> bool:
    locks = [reference() for reference in list(getattr(_bootstrap, "_module_locks", {}).values())]
    owners = {getattr(lock, "owner", None) for lock in locks}
    return bool(owners - {None, threading.get_ident()})


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep linear algebra to one thread: it is small here, and threads that wait for it burn their cores."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield


Given = TypeVar("Given")
Found = TypeVar("Found")


def at_once(do: Callable[[Given], Found], things: Iterable[Given], jobs: int) -> list[Found]:
    """Return what is done to each, in their order, `jobs` at once."""
    given = list(things)
    if jobs == 1 or len(given) < 2:
        return list(map(do, given))
    with thread_pool(min(jobs, len(given))) as pool:
        return list(pool.map(do, given))
