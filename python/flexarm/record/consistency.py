"""Consistency of the tables of `record.toml`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from flexarm.arm.consistency import missing
from flexarm.quantities import DRIVES
from flexarm.tables.field import Path
from flexarm.units import factor_to

if TYPE_CHECKING:
    from flexarm.record.file_table import RecordTable

Found = Iterable[tuple[Path, str]]


def inconsistencies(record: RecordTable) -> list[tuple[Path, str]]:
    """Return pairs of place and sentence for all that does not fit."""
    if not record.signals:
        return [(("signals",), "is missing; a record needs at least one signal")]
    return [*references(record), *_stamps(record)]


def references(run: Any) -> Found:
    """Yield names that are used twice, or that nothing has, in a table of a run with its `signals`."""
    yield from _names(run)
    yield from _clocks_and_frames(run)
    yield from _drive(run)


def _names(record: Any) -> Found:
    seen: set[str] = set()
    for i, signal in enumerate(record.signals):
        if signal.name in seen:
            yield ("signals", i, "name"), f"{signal.name!r} is used twice; names of signals must differ"
        seen.add(signal.name)


def _clocks_and_frames(record: Any) -> Found:
    if record.clocks and next(iter(record.clocks.values())).unknown:
        yield (
            ("clocks", next(iter(record.clocks))),
            "is the reference, the first clock, and cannot be unknown",
        )
    for i, signal in enumerate(record.signals):
        if signal.clock is not None and signal.clock not in record.clocks:
            yield ("signals", i, "clock"), missing("clock", signal.clock, record.clocks)
        if signal.frame not in ("base", *record.frames):
            yield ("signals", i, "frame"), missing("frame", signal.frame, ["base", *record.frames])


def _stamps(record: RecordTable) -> Found:
    for i, signal in enumerate(record.signals):
        static = record.kind == "static"
        needed, unwanted = ("pose", "time") if static else ("time", "pose")
        if getattr(signal, needed) is None:
            yield ("signals", i, needed), f"is missing; needed is the name of the column of {needed}s"
        if getattr(signal, unwanted) is not None:
            yield (
                ("signals", i, unwanted),
                f"does not belong to a record of kind {record.kind!r}; use {needed}",
            )
        if signal.spec.only_static and not static:
            yield (
                ("signals", i, "quantity"),
                (
                    f'{signal.quantity} belongs to records of kind "static"; '
                    "what a run carried stands in [payloads]"
                ),
            )
        if factor_to("s", signal.time_unit) is None:
            yield (
                ("signals", i, "time_unit"),
                f"unit {signal.time_unit!r} does not fit; allowed are s, ms, us, ns, min",
            )


def _drive(record: Any) -> Found:
    signals = {signal.name: signal for signal in record.signals}
    driven: dict[str | None, str] = {}
    for name in record.drive:
        if name not in signals:
            yield ("drive",), missing("signal", name, signals)
            continue
        signal = signals[name]
        if signal.quantity not in DRIVES:
            yield ("drive",), f"signal {name!r} is a {signal.quantity}; a drive is one of {', '.join(DRIVES)}"
        elif signal.joint in driven:
            yield (
                ("drive",),
                f"signals {driven[signal.joint]!r} and {name!r} both drive joint {signal.joint!r}",
            )
        driven[signal.joint] = name
    for joint in record.joints:
        if joint in driven:
            yield (
                ("joints", joint),
                f"is driven by signal {driven[joint]!r} and cannot stand at a fixed value",
            )
