"""MDF 3 and 4: channels by name; "log" is the master channel of their group."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.importing.source import LOG, Array, Group, Source, Unreadable, needed, shared_stamps


class MdfLog(Source):
    """An MDF file; a topic is the name of a group, or its number counted from 1."""

    tried_apart = True

    @contextmanager
    def _open(self) -> Iterator[Any]:
        module = needed("asammdf", self.path)
        # As an open file: of a path that it cannot read it complains once more when it is cleared away.
        with self.path.open("rb") as raw, module.MDF(raw) as file:
            yield file

    def _channels(self, file: Any, topic: str | None) -> list[tuple[str, int, int]]:
        """Return name, group and number of the channels of a topic, masters left out."""
        labels = [str(getattr(group.channel_group, "acq_name", "") or "") for group in file.groups]
        chosen = [k for k, name in enumerate(labels) if topic in (None, name, str(k + 1))]
        if not chosen:
            known = [name or str(k + 1) for k, name in enumerate(labels)]
            raise Unreadable("topic", missing("group", str(topic), known))
        return [
            (channel.name, k, number)
            for k in chosen
            for number, channel in enumerate(file.groups[k].channels)
            if number != file.masters_db.get(k)
        ]

    def names(self, topic: str | None) -> list[str]:
        """Return the channels."""
        with self._open() as file:
            return [name for name, _, _ in self._channels(file, topic)]

    def array(self, topic: str | None, index: int) -> Array:
        """Return a channel, in its physical values."""
        with self._open() as file:
            _, group, number = self._channels(file, topic)[index]
            signal = file.get(group=group, index=number, ignore_invalidation_bits=True)
            samples, invalid = np.asarray(signal.samples), signal.invalidation_bits
            if invalid is None or not np.any(invalid):
                return samples
            samples = samples.astype(float if samples.dtype.kind in "fiub" else object)
            samples[np.asarray(invalid, dtype=bool)] = np.nan
            return samples

    def log_time(self, topic: str | None, indices: Sequence[int]) -> tuple[Array, str]:
        """Return the time of the group's master from the start of the measurement."""
        with self._open() as file:
            channels = self._channels(file, topic)
            masters: dict[int, tuple[str, tuple[Array, str]]] = {}
            for name, group, _ in (channels[index] for index in indices):
                unit = _unit_of(file, group, file.masters_db.get(group)) or "s"
                masters.setdefault(group, (name, (np.asarray(file.get_master(group)), unit)))
            return shared_stamps(list(masters.values()))

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit of a channel."""
        with self._open() as file:
            _, group, number = self._channels(file, topic)[index]
            return _unit_of(file, group, number)

    def groups(self) -> list[Group]:
        """Return the groups."""
        found: dict[int, list[tuple[str, str]]] = {}
        with self._open() as file:
            for name, group, number in self._channels(file, None):
                found.setdefault(group, []).append((name, _unit_of(file, group, number)))
        return [
            Group(str(k + 1), tuple(n for n, _ in names), LOG, units=tuple(u for _, u in names))
            for k, names in found.items()
        ]


def _unit_of(file: Any, group: int, number: int | None) -> str:
    channels = file.groups[group].channels
    return "" if number is None else str(getattr(channels[number], "unit", "") or "")
