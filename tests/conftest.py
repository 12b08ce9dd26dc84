"""Fixtures for all tests."""

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

# A job in the background of a script is deaf to the interrupt key, and so would be what tests start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


SLOW = ("measured", "golden", "notebooks")
"""Folders whose tests take minutes: `make check` runs them, as all that is marked so in other folders."""


FIRST = ("torture", *SLOW)
"""Folders whose files take longest, so that no worker is left with one of them at the end."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if _folder(item) in SLOW:
            item.add_marker(pytest.mark.slow)
    items.sort(key=lambda item: _folder(item) not in FIRST)


def _folder(item: pytest.Item) -> str:
    return item.path.relative_to(ROOT / "tests").parts[0]


@pytest.fixture(scope="session")
def shared_dir() -> Path:
    """Folder with cases and data that come with the project but not with its repository."""
    folder = Path(os.environ.get("FLEXARM_SHARED", ROOT.parent / "shared"))
    if not folder.is_dir():
        pytest.skip(f"no folder {folder}; FLEXARM_SHARED names another one")
    return folder


@pytest.fixture(autouse=True)
def closed_figures() -> Iterator[None]:
    """Figures that a test leaves open are closed, or matplotlib warns of them in some later one."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
