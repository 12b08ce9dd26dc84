"""How far a campaign is, while it runs and where it is stopped."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from flexarm.campaigns.store import Store
from flexarm.errors import InvalidFile
from flexarm.termination import told_on_exit

Tell = Callable[[float, str], object]


@dataclass
class Tally:
    """How many runs are done, their rate, and the time left."""

    count: int
    before: int
    tell: Tell
    added: int = 0
    began: float = field(default_factory=time.monotonic)

    @property
    def done(self) -> int:
        """Number of runs that are done."""
        return self.before + self.added

    def add(self, more: int) -> None:
        """Count more runs as done, and tell."""
        self.added += more
        rate = self.added / max(time.monotonic() - self.began, 1e-9)
        left = (self.count - self.done) / rate
        self.tell(self.done / self.count, f"{self.done}/{self.count} runs, {rate:.3g}/s, {_clock(left)} left")


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@contextmanager
def resumable(store: Store, tally: Tally) -> Iterator[None]:
    """Say what is kept, if the process leaves within the block or cannot write a file."""

    def kept() -> str:
        return f"{tally.done} of {tally.count} runs are kept in {store.directory}; --resume goes on"

    with told_on_exit(kept):
        try:
            yield
        except InvalidFile as error:
            if error.where != "output":
                raise
            raise InvalidFile(error.file, "output", f"{error.problems[0].what}; {kept()}") from None
