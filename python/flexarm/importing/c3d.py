"""C3D of motion capture: coordinates of a marker are `tip.x`; the topic `analog` has the other channels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import LOG, Array, Group, Request, Source, Unreadable, needed

TOPICS = {"points": "POINT", "analog": "ANALOG"}


class C3dFile(Source):
    """A C3D file; without a topic its points."""

    tried_apart = True

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        super().__init__(path, dialect, requests)
        self._file: Any = needed("ezc3d", path).c3d(str(path))

    def _parameter(self, topic: str | None, name: str) -> list[Any]:
        topic = topic or "points"
        if topic not in TOPICS:
            raise Unreadable("topic", missing("topic", topic, TOPICS))
        group = self._file["parameters"].get(TOPICS[topic], {})
        return list(group.get(name, {"value": []})["value"])

    def names(self, topic: str | None) -> list[str]:
        """Return coordinates of markers, or analogue channels."""
        labels: list[str] = []
        for number in ("", *range(2, 100)):  # more than 255 labels go on in LABELS2
            more = self._parameter(topic, f"LABELS{number}")
            if not more:
                break
            labels += [str(label).strip() for label in more]
        return labels if topic == "analog" else [f"{label}.{axis}" for label in labels for axis in "xyz"]

    def array(self, topic: str | None, index: int) -> Array:
        """Return a channel; markers that were not seen are NaN."""
        if topic == "analog":
            return np.asarray(self._file["data"]["analogs"][0, index])
        return np.asarray(self._file["data"]["points"][index % 3, index // 3])

    def log_time(self, topic: str | None, indices: Sequence[int]) -> tuple[Array, str]:
        """Return the time from the first frame, by the rate that the file states."""
        rate = float((self._parameter(topic, "RATE") or [0])[0])
        if rate <= 0:
            raise Unreadable("time", "states no rate; say { rate_hz = }")
        return np.arange(len(self.array(topic, indices[0]))) / rate, "s"

    def groups(self) -> list[Group]:
        """Return points and analogue channels."""
        found = []
        for topic in TOPICS:
            if names := tuple(self.names(topic)):
                units = [str(unit) for unit in self._parameter(topic, "UNITS")]
                each = units if topic == "analog" else units[:1] * len(names)
                found.append(Group(topic, names, LOG, units=tuple(each)))
        return found
