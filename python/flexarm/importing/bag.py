"""ROS 1 and 2 bags and MCAP: messages of a topic, read one after the other in bounded memory.

A field is a path such as `pose.position.x`. `[shoulder]` picks from a list by the names that stand beside it
(`name`, `names`, `joint_names`) or, of a list of messages, by `child_frame_id`, `name` or `id`; `[2]` by
number. A message that has none of the fields is passed over, as one of another robot on the same topic is.
"""

from __future__ import annotations

import io
import os
import re
from array import array
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import LOG, Array, Group, Request, Samples, Source, Unreadable, needed

NAME_LISTS = ("name", "names", "joint_names")
NAMED_BY = ("child_frame_id", "name", "id")
MOST_ENTRIES = 200
"""Entries of a list that are fields, named or numbered; images, scans and clouds have more."""
_STEP = re.compile(r"([^.\[\]]+)|\[([^\]]+)\]")

Steps = tuple[tuple[str, bool], ...]
"""Words of a path, and True for those in brackets."""


def steps_of(path: str) -> Steps:
    """Return the steps of a path.

    >>> steps_of("position[shoulder]")
    (('position', False), ('shoulder', True))
    """
    return tuple((match[1] or match[2], match[1] is None) for match in _STEP.finditer(path))


def value_at(message: Any, steps: Steps) -> Any:
    """Return what a message holds at a path, or None."""
    owners = [message]
    for word, in_brackets in steps:
        value = owners[-1]
        value = _picked(value, word, owners) if in_brackets else getattr(value, word, None)
        if value is None:
            return None
        owners.append(value)
    return owners[-1]


def _picked(values: Any, word: str, owners: Sequence[Any]) -> Any:
    if not hasattr(values, "__len__") or isinstance(values, str):
        return None
    for owner in reversed(owners):
        for label in NAME_LISTS:
            names = getattr(owner, label, None)
            if isinstance(names, list) and word in names and names.index(word) < len(values):
                return values[names.index(word)]
    for value in values:
        if any(getattr(value, label, None) == word for label in NAMED_BY):
            return value
    number = int(word) if word.isdigit() else 0
    return values[number - 1] if 0 < number <= len(values) else None


class _Column:
    """Values of one path, message by message."""

    def __init__(self, path: str) -> None:
        self.steps = steps_of(path)
        self.numbers = array("d")
        self.texts: list[str] = []
        self.seen = False

    def value(self, message: Any) -> Any:
        found = value_at(message, self.steps)
        self.seen = self.seen or found is not None
        return found

    def add(self, value: Any) -> None:
        if isinstance(value, str):
            self.texts += [""] * (len(self.numbers) - len(self.texts)) + [value]
            value = None
        self.numbers.append(np.nan if value is None else float(value))

    def array(self) -> Array:
        if self.texts:
            return np.array(self.texts + [""] * (len(self.numbers) - len(self.texts)))
        return np.frombuffer(self.numbers, dtype=float) if len(self.numbers) else np.array([])


class _Collector:
    """Samples of one request."""

    def __init__(self, request: Request) -> None:
        self.columns = [_Column(str(column)) for column in request.columns]
        self.others = [_Column(str(column)) for _, column in request.others]
        self.by_log = request.time == LOG
        self.stamp = None if request.time is None or self.by_log else steps_of(str(request.time))
        self.whole, self.real = array("q"), array("d")
        self.stamped = request.time is None or self.by_log

    def add(self, message: Any, logged: int) -> None:
        values = [column.value(message) for column in self.columns]
        if all(value is None for value in values):
            return
        if self.by_log:
            self.whole.append(logged)
        elif self.stamp is not None:
            stamp = value_at(message, self.stamp)
            if stamp is None:
                return
            self.stamped = True
            if hasattr(stamp, "nanosec"):
                self.whole.append(stamp.sec * 1_000_000_000 + stamp.nanosec)
            else:
                self.real.append(float(stamp))
        for column, value in zip(self.columns, values, strict=True):
            column.add(value)
        for other in self.others:
            other.add(other.value(message))

    def time(self) -> tuple[Array | None, str | None]:
        if len(self.whole):
            return np.frombuffer(self.whole, dtype=np.int64), "ns"
        return (np.frombuffer(self.real, dtype=float) if len(self.real) else None), None


class _File(io.BufferedReader):
    """A file that gives no more than it holds: lengths in a damaged log ask for any amount of memory."""

    def read(self, size: int | None = -1) -> bytes:
        """Return the next bytes, as many as the file holds at most."""
        return super().read(-1 if size is None else min(size, os.fstat(self.fileno()).st_size))


class _Bounded(type(Path())):  # type: ignore[misc]  # a class of the system's own
    """A path whose files, and those below it, are opened so."""

    def open(self, mode: str = "r", *args: Any, **more: Any) -> Any:
        """Open the file, one of bytes as `_File`."""
        return _File(io.FileIO(self)) if mode == "rb" else super().open(mode, *args, **more)


class Bag(Source):
    """A bag of ROS 1 or 2, or an MCAP file."""

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        super().__init__(path, dialect, requests)
        self._collected: dict[Request, _Collector] | None = None
        with self._open() as reader:
            self._topics = {topic: info.msgtype or "" for topic, info in sorted(reader.topics.items())}

    @contextmanager
    def _open(self) -> Iterator[Any]:
        module, stores = needed("rosbags.highlevel", self.path), needed("rosbags.typesys", self.path)
        default = stores.get_typestore(stores.Stores.LATEST)
        with module.AnyReader([_Bounded(self.path)], default_typestore=default) as reader:
            yield reader

    def names(self, topic: str | None) -> list[str]:
        """Return the fields that the first messages of a topic hold."""
        looked_at = 20  # messages of a topic that show which fields it has
        found: dict[str, None] = {}
        with self._open() as reader:
            connections = [each for each in reader.connections if each.topic == self._known(topic)]
            for count, (connection, _, raw) in enumerate(reader.messages(connections=connections)):
                if count == looked_at:
                    break
                found |= dict.fromkeys(fields_of(reader.deserialize(raw, connection.msgtype)))
        return list(found)

    def _known(self, topic: str | None) -> str:
        if topic is None:
            raise Unreadable("topic", f"is missing; there are {', '.join(self._topics) or 'none'}")
        if topic not in self._topics:
            raise Unreadable("topic", missing("topic", topic, self._topics))
        return topic

    def groups(self) -> list[Group]:
        """Return the fields of topics by the stamp that they stand beside."""
        found = []
        for topic, kind in self._topics.items():
            names = self.names(topic)
            stamps = {name.removesuffix("header.stamp"): name for name in names if name.endswith("stamp")}
            fields: dict[str, list[str]] = {}
            for name in (name for name in names if not name.endswith("stamp")):
                beside = [start for start in stamps if name.startswith(start)]
                fields.setdefault(stamps[max(beside, key=len)] if beside else LOG, []).append(name)
            found += [Group(topic, tuple(each), stamp, kind) for stamp, each in fields.items()]
        return found

    def array(self, topic: str | None, index: int) -> Array:
        """Return one field of a topic."""
        return self.read(Request(topic, (self.names(topic)[index],))).values[:, 0]

    def place(self, topic: str | None, row: int) -> str:
        """Return the message of a row, of those that hold the fields."""
        return f"message {row + 1} of {topic}"

    def read(self, request: Request) -> Samples:
        """Return the samples of a request; the first call reads those of all."""
        self._known(request.topic)
        if any(isinstance(column, int) for column in request.columns):
            raise Unreadable("columns", "fields of messages have names, and no numbers")
        if self._collected is None or request not in self._collected:
            self._collected = {**(self._collected or {}), **self._collect({*self.requests, request})}
        found = self._collected[request]
        for column, path in zip(found.columns, request.columns, strict=True):
            if not column.seen:
                raise Unreadable("columns", missing("field", str(path), self.names(request.topic)))
            if column.texts:
                raise Unreadable("columns", f"{path}: must be a number, got {column.texts[-1][:40]!r}")
        if not found.stamped:
            stamps = [name for name in self.names(request.topic) if name.endswith("stamp")]
            what = missing("stamp", str(request.time), stamps)
            raise Unreadable("time", f'{what}; "log" is the time at which a message was recorded')
        time, unit = found.time()
        values = np.stack([column.array() for column in found.columns], axis=1)
        return Samples(values, time, unit, tuple(column.array() for column in found.others))

    def _collect(self, requests: set[Request]) -> dict[Request, _Collector]:
        collected = {request: _Collector(request) for request in requests if request.topic in self._topics}
        by_topic: dict[str | None, list[_Collector]] = {}
        for request, collector in collected.items():
            by_topic.setdefault(request.topic, []).append(collector)
        with self._open() as reader:
            connections = [each for each in reader.connections if each.topic in by_topic]
            for connection, logged, raw in reader.messages(connections=connections):
                message = reader.deserialize(raw, connection.msgtype)
                for collector in by_topic[connection.topic]:
                    collector.add(message, logged)
        return collected


def fields_of(message: Any, prefix: str = "") -> Iterator[str]:
    """Yield the paths of all numbers and stamps in a message."""
    names = next((getattr(message, label) for label in NAME_LISTS if _is_texts(message, label)), ())
    for label in getattr(message, "__dataclass_fields__", ()):
        value, path = getattr(message, label, None), f"{prefix}{label}"
        if label == "__msgtype__" or value is None or isinstance(value, str):
            continue
        if hasattr(value, "nanosec"):
            yield path
        elif hasattr(value, "__dataclass_fields__"):
            yield from fields_of(value, f"{path}.")
        elif hasattr(value, "__len__"):
            yield from _entries(value, path, names)
        else:
            yield path


def _is_texts(message: Any, label: str) -> bool:
    value = getattr(message, label, None)
    return isinstance(value, list) and bool(value) and all(isinstance(text, str) for text in value)


def _entries(values: Any, path: str, names: Sequence[str]) -> Iterator[str]:
    """Yield the paths of the entries of a list that is not too long; of one as long as its names by name."""
    if len(values) and hasattr(values[0], "__dataclass_fields__"):
        for number, entry in enumerate(values, 1):
            key = next((k for label in NAMED_BY if isinstance(k := getattr(entry, label, None), str)), number)
            yield from fields_of(entry, f"{path}[{key}].")
    elif not 0 < len(values) <= MOST_ENTRIES or isinstance(values[0], str):
        return
    elif len(values) == len(names):
        yield from (f"{path}[{name}]" for name in names)
    else:
        yield from (f"{path}[{number}]" for number in range(1, len(values) + 1))
