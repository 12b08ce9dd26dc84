"""The text of a proposed map: each key with its reason, and what is not known."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.importing.guess.logged import Logged
from flexarm.importing.map_file import FORMAT
from flexarm.units import factor_to

if TYPE_CHECKING:
    from flexarm.importing.guess.proposal import Proposal


DRIVING = ("joint_angle", "joint_command")
"""Quantities that can drive a model."""


def map_text(
    model: str,
    drives: Sequence[Proposal],
    proposals: Sequence[Proposal],
    left: Sequence[Logged],
    frames: Mapping[str, str],
) -> str:
    """Return the map: clocks and frames, signals, and the columns that are not taken."""
    lines = [
        "# Proposed from names, rates, ranges and the model's motion. Read every line, above all those that",
        '# say "unknown", before you trust what comes out.',
        f"format = {_value(FORMAT)}",
        f"model = {_value(model)}",
    ]
    poses = any(p.first.time.poses for p in proposals)
    lines += ['kind = "static"  # poses: neighbouring rows are no neighbours of a motion'] if poses else []
    waiting = [] if drives else [p for p in proposals if p.out and p.quantity in DRIVING]
    if drives:
        lines.append(f"drive = {_value([p.name for p in drives])}  # angles or commands of the joints")
    elif waiting:
        lines.append(
            "# unknown: drive; the angles below are commented out: say what they lack, and uncomment them"
        )
        lines.append(f"# drive = {_value([p.name for p in waiting])}")
    else:
        lines.append("# unknown: drive; no column is the angle or command of a joint")
    clocked = [] if poses else [*drives, *waiting, *(p for p in proposals if not p.out)]
    files = list(dict.fromkeys(p.first.file for p in clocked))
    clocks = {clock_of(p): clock_name(p, files) for p in clocked}
    lines += ["", "[clocks]", *_clocks(clocks, clocked)] if len(clocked) > len(waiting) else []
    if frames:
        lines += ["", "[frames]"]
        lines += [f"{name} = {_value('unknown')}  # {why}" for name, why in frames.items()]
    for proposal in proposals:
        body = list(_signal(proposal, clocks))
        lines += ["", *(f"# {line}".rstrip() for line in body)] if proposal.out else ["", *body]
    lines += ["", *_left(left)] if left else []
    return "\n".join(lines) + "\n"


def clock_of(proposal: Proposal) -> tuple[str, str]:
    """Return the file of a signal's clock, and the signal if the clock is its own."""
    return proposal.first.file, proposal.name if proposal.own_clock else ""


def clock_name(proposal: Proposal, files: Sequence[str]) -> str:
    """Return the name of a signal's clock: of its file, and of the signal if the clock is its own."""
    file = proposal.first.file
    plain = re.sub(r"[^\w-]+", "_", Path(file).stem).strip("_") or "log"
    alike = [other for other in files if Path(other).stem == Path(file).stem]
    name = plain if len(alike) == 1 else f"{plain}_{alike.index(file) + 1}"
    return f"{name}_{proposal.name}" if proposal.own_clock else name


def _clocks(clocks: Mapping[tuple[str, str], str], proposals: Sequence[Proposal]) -> Iterator[str]:
    calendar = {p.first.file: p.first.time.of_calendar for p in proposals}
    (first, _), *_ = clocks
    for k, ((file, own), name) in enumerate(clocks.items()):
        if k == 0:
            yield f"{name} = 0.0  # the reference: stamps of {file}"
            continue
        both = calendar[file] and calendar[first]
        why = "both count from 1970: if they were synchronised, write 1 sigma [s]" if both else "another file"
        why = f"the signal {own} shows a delay" if own else why
        yield f"{name} = {_value('unknown')}  # unknown: how late its stamps are; {why}"


def _signal(proposal: Proposal, clocks: Mapping[tuple[str, str], str]) -> Iterator[str]:
    first, time = proposal.first, proposal.first.time
    kind, place = proposal.place
    keys: dict[str, Any] = {"name": proposal.name, "source": first.file}
    if first.topic is not None:
        keys["topic"] = first.topic
    if time.pose is not None:
        keys["pose"] = time.pose
    if not time.poses:
        keys["time"] = time.column if time.column is not None else {"rate_hz": 1.0}
    if time.unit not in (None, "s"):
        keys["time_unit"] = time.unit
    if time.form is not None:
        keys["time_format"] = time.form
    if first.where:
        keys["where"] = dict(first.where)
    keys["columns"] = [column.column for column in proposal.columns]
    keys["quantity"] = proposal.quantity
    keys[kind] = place or "unknown"
    keys |= proposal.keys
    if clock_of(proposal) in clocks:
        keys["clock"] = clocks[clock_of(proposal)]
    why = {"time": time.why, **proposal.why}
    unknown = dict(proposal.unknown)
    if time.unknown:
        unknown["time"] = time.unknown
    if time.column is None and not time.poses:
        unknown["time"] = "the rate; 1 Hz stands for it"
    yield "[[signals]]"
    for key, value in keys.items():
        if key in unknown:
            yield f"# unknown: {key}: {unknown.pop(key)}"
        reason = f"  # {why[key]}" if why.get(key) else ""
        yield f"{key} = {_value(value)}{reason}"
    for key, what in unknown.items():
        yield f"# unknown: {key}: {what}"


def _left(left: Sequence[Logged]) -> Iterator[str]:
    most_listed = 40  # columns that are not taken and listed one by one
    yield "# Columns that are not taken:"
    for column in left[:most_listed]:
        topic = f", {column.topic}" if column.topic is not None else ""
        quantity, unit = column.meaning.quantity, column.meaning.unit
        what = f"may be {quantity}" if quantity else "unknown"
        if not quantity and unit and factor_to("Pa", unit) is not None:
            what = "a pressure; see `sum` in docs/importing.md for the force of a cylinder"
        what += f", always {column.values[0]:g}" if column.rests else ""
        yield f"# {column.file}{topic}: {_value(column.column)}: {what}".replace("\n", " ")
    if len(left) > most_listed:
        yield f"# and {len(left) - most_listed} more"


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z_][\w-]*", key, re.ASCII) else _value(key)


def _value(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
