"""Consistency of the tables of `record.toml`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from flexarm.arm.consistency import missing
from flexarm.errors import InvalidParameter
from flexarm.quantities import DRIVES
from flexarm.tables.field import Path
from flexarm.units import factor_to, ratio_factor

if TYPE_CHECKING:
    from flexarm.record.file_table import RecordTable, SignalTable

Found = Iterable[tuple[Path, str]]


def inconsistencies(record: RecordTable) -> list[tuple[Path, str]]:
    """Return pairs of place and sentence for all that does not fit."""
    if not record.signals:
        return [(("signals",), "is missing; a record needs at least one signal")]
    return [*references(record), *responses(record), *_files(record), *_stamps(record)]


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
        what = "is the reference, the first clock, and cannot be unknown"
        yield ("clocks", next(iter(record.clocks))), what
    for i, signal in enumerate(record.signals):
        if signal.clock is not None and signal.clock not in record.clocks:
            yield ("signals", i, "clock"), missing("clock", signal.clock, record.clocks)
        if signal.frame not in ("base", *record.frames):
            yield ("signals", i, "frame"), missing("frame", signal.frame, ["base", *record.frames])


STAMPS = {"motion": "time", "static": "pose", "frequency_response": "frequency"}
"""What the rows of a record of each kind are told by."""


def is_input(record: RecordTable, signal: SignalTable) -> bool:
    """Return True for the input of a frequency response, of which no values are read."""
    return record.kind == "frequency_response" and signal.input is None


def _files(record: RecordTable) -> Found:
    for i, signal in enumerate(record.signals):
        if is_input(record, signal):
            continue
        if not signal.file:
            yield ("signals", i, "file"), "is missing; needed is name of a CSV file in the record's directory"
        if not signal.channels:
            yield ("signals", i, "channels"), "is missing; needed is names of the columns of values"


def _stamps(record: RecordTable) -> Found:
    needed = STAMPS[record.kind]
    for i, signal in enumerate(record.signals):
        static = record.kind == "static"
        if getattr(signal, needed) is None and not is_input(record, signal):
            plural = "frequencies" if needed == "frequency" else f"{needed}s"
            yield ("signals", i, needed), f"is missing; needed is the name of the column of {plural}"
        for unwanted in STAMPS.values():
            if unwanted != needed and getattr(signal, unwanted) is not None:
                what = f"does not belong to a record of kind {record.kind!r}; use {needed}"
                yield ("signals", i, unwanted), what
        if signal.spec.only_static and not static:
            what = (
                f'{signal.quantity} belongs to records of kind "static"; '
                "what a run carried stands in [payloads]"
            )
            yield ("signals", i, "quantity"), what
        if factor_to("s", signal.time_unit) is None:
            what = f"unit {signal.time_unit!r} does not fit; allowed are s, ms, us, ns, min"
            yield ("signals", i, "time_unit"), what


INPUTS = ("force", "motor_torque", "joint_angle")
"""Quantities to which a frequency response may be."""


def response_unit(table: Any, to: Any) -> tuple[str, float]:
    """Return the SI unit of a frequency response and the factor to it, from the tables of both signals.

    Raise InvalidParameter if its unit is not one of output per input.
    """
    (above, below), factor = ratio_factor(table.unit, table.spec.units, to.spec.units)
    return f"{above}/({below})" if " " in below or "/" in below else f"{above}/{below}", factor


def responses(record: Any) -> Found:
    """Yield what is wrong with the inputs and units of frequency responses, in a table with its `signals`."""
    signals = {signal.name: signal for signal in record.signals}
    ringing = record.kind == "frequency_response"
    if ringing and record.drive:
        yield ("drive",), "does not belong to a record of kind 'frequency_response'; signals name their input"
    if ringing and all(signal.input is None for signal in record.signals):
        yield ("signals",), "hold no response: none has an input, the name of another signal"
    for i, signal in enumerate(record.signals):
        if signal.input is None:
            continue
        to = signals.get(signal.input)
        if not ringing:
            what = f"belongs to a record of kind 'frequency_response', not {record.kind!r}"
            yield ("signals", i, "input"), what
        elif to is None:
            others = [name for name in signals if name != signal.name]
            yield ("signals", i, "input"), missing("signal", signal.input, others)
        elif to.input is not None:
            yield ("signals", i, "input"), f"{to.name!r} is a response itself, to {to.input!r}"
        elif to.quantity not in INPUTS or len(to.directions) > 1:
            what = f"{to.name!r} is a {to.quantity} along {len(to.directions) or 1} axes"
            yield ("signals", i, "input"), f"{what}; an input is a {', '.join(INPUTS)}, of one axis"
        else:
            try:
                response_unit(signal, to)
            except InvalidParameter as error:
                yield ("signals", i, "unit"), error.problems[0].what


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
            what = f"signals {driven[signal.joint]!r} and {name!r} both drive joint {signal.joint!r}"
            yield ("drive",), what
        driven[signal.joint] = name
    for joint in record.joints:
        if joint in driven:
            what = f"is driven by signal {driven[joint]!r} and cannot stand at a fixed value"
            yield ("joints", joint), what
