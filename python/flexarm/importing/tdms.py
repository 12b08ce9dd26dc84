"""TDMS of LabVIEW: a topic is a group; "log" is the time of a waveform."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.importing.source import LOG, Array, Group, Source, Unreadable, needed, shared_stamps
from flexarm.reading import BoundedFile


class TdmsLog(Source):
    """A TDMS file; the topic may be left out where there is one group."""

    @contextmanager
    def _group(self, topic: str | None) -> Iterator[Any]:
        with BoundedFile(self.path) as raw, needed("nptdms", self.path).TdmsFile.open(raw) as file:
            names = [group.name for group in file.groups()]
            topic = names[0] if topic is None and len(names) == 1 else topic
            if topic not in names:
                what = f"is missing; there are {', '.join(names)}"
                raise Unreadable("topic", what if topic is None else missing("group", topic, names))
            yield file[topic]

    def names(self, topic: str | None) -> list[str]:
        """Return the channels of a group."""
        with self._group(topic) as group:
            return [channel.name for channel in group.channels()]

    def array(self, topic: str | None, index: int) -> Array:
        """Return a channel."""
        with self._group(topic) as group:
            return np.asarray(group.channels()[index][:])

    def log_time(self, topic: str | None, indices: Sequence[int]) -> tuple[Array, str]:
        """Return the time of a waveform: since 1970 [ns] if it has a start, else from zero [s]."""
        with self._group(topic) as group:
            channels = group.channels()
            return shared_stamps([(channels[i].name, _waveform_time(channels[i])) for i in indices])

    def time_unit(self, topic: str | None, index: int) -> str:
        """Return the unit of a channel."""
        with self._group(topic) as group:
            return str(group.channels()[index].properties.get("unit_string", ""))

    def groups(self) -> list[Group]:
        """Return the groups."""
        found = []
        with BoundedFile(self.path) as raw, needed("nptdms", self.path).TdmsFile.open(raw) as file:
            for group in file.groups():
                channels = group.channels()
                waveform = any(channel.properties.get("wf_increment") for channel in channels)
                units = tuple(str(channel.properties.get("unit_string", "")) for channel in channels)
                names = tuple(channel.name for channel in channels)
                found.append(Group(group.name, names, LOG if waveform else None, units=units))
        return found


def _waveform_time(channel: Any) -> tuple[Array, str]:
    """Return the stamps of a waveform, and their unit."""
    said = channel.properties
    if not said.get("wf_increment"):
        what = f"channel {channel.name!r} is no waveform; name a channel of stamps, or {{ rate_hz = }}"
        raise Unreadable("time", what)
    time = said.get("wf_start_offset", 0.0) + said["wf_increment"] * np.arange(len(channel))
    start = said.get("wf_start_time")
    if start is None:
        return time, "s"
    return np.datetime64(start, "ns").astype(np.int64) + np.rint(1e9 * time).astype(np.int64), "ns"
