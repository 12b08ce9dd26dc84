"""`flexarm check`: what a file is, and every problem in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexarm.cli.options import AllowOutside, Json, MaxSeconds, print_json, refuse, warn
from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.opening import MESHES

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.weight import Body, WeightStatement
    from flexarm.record import Record
    from flexarm.record.table import CarriedPayload

Told = tuple[dict[str, Any], list[str], list[Problem], list[Problem]]
"""For programs, in lines for a person, warnings, and errors beside which the rest is told."""
Faults = list[tuple[Path, Problem]]
"""Problems that make data unusable, each with its file."""


def check(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A model (TOML), a record (directory) or a super-element.")
    ],
    records: Annotated[
        list[Path] | None, typer.Argument(metavar="RECORD", help="Records of what PATH is the model of.")
    ] = None,
    json: Json = False,
    allow_outside: AllowOutside = False,
    max_seconds: MaxSeconds = None,
) -> None:
    """Say what a file is and what is wrong with it.

    For a model: joints, links, effects, what is uncertain, where loops close, and the weights there or at
    q = 0: mass [kg], centre [m] and inertia [kg m2] of each link and of the whole, in the base's frame. For a
    record: its signals with rates [Hz], drop-outs and clocks. For a super-element: mass, interfaces, modes,
    and whether rigid motion strains it.

    MODEL RECORD... also tests whether the sensors can be right, before a long diagnosis. It finds channels
    that are dead, reversed, saturated or in another unit, outliers, jumps of a clock, and noise unlike the
    stated one. A faulty sensor makes the data unusable: the exit code is then 2, as for a file that cannot be
    read. Remarks and warnings leave it at 0. Where values can hardly be of this arm, correct them first: no
    sensor is judged until then.

        flexarm check arm.toml
        flexarm check measured --json
        flexarm check arm.toml measured
        flexarm check hub.nc
    """
    faults: Faults = []
    try:
        if records:
            if _reader(path) is not _model:
                what = "is no model; records are checked beside one: check MODEL RECORD..."
                raise InvalidFile(path, "PATH", what)
            from flexarm.cli.check_records import check_records

            told, lines, faults = check_records(path, records, max_seconds, json)
            warnings: list[Problem] = []
        else:
            told, lines, warnings, wrong = _reader(path)(path)
            faults = [(path, problem) for problem in wrong]
    except InvalidFile as error:
        if json:
            print_json({"path": str(path), "problems": [_plain(problem) for problem in error.problems]})
        raise
    if json:
        problems = [_plain(problem) for _, problem in faults]
        print_json({"path": str(path), **told, "problems": problems, "warnings": list(map(_plain, warnings))})
    else:
        print("\n".join(lines))
    warn(path, warnings)
    refuse(faults)


def _reader(path: Path) -> Callable[[Path], Told]:
    if path.is_dir() or path.name == "record.toml":
        return _record
    if path.suffix in MESHES:
        what = "is a mesh, no model; `flexarm reduce` checks it and makes it a super-element"
        raise InvalidFile(path, "path", what)
    return _superelement if path.suffix == ".nc" else _model


def _plain(problem: Problem) -> dict[str, Any]:
    return {"where": problem.where, "what": problem.what, "line": problem.line}


def _model(path: Path) -> Told:
    from flexarm.arm import Arm

    arm = Arm.from_toml(path)
    told: dict[str, Any] = {"kind": "model", **_outline(arm)}
    lines, warnings, faults = [arm.summary()], list(arm.warnings), list[Problem]()
    closed: dict[str, float] = {}
    if arm.closures:
        from flexarm.assembly import loops_of

        try:
            closing = loops_of(arm)
            told["loops"] = {"assembled": closing.assembled, "redundant_conditions": closing.redundant}
            closed = told["loops"]["assembled"]
            lines += ["", *_loop_lines(told["loops"], arm.assembly)]
        except InvalidParameter as error:
            faults += error.problems
    try:
        weight = _weight(arm, closed)
    except InvalidParameter as error:
        return told, lines, warnings + list(error.problems), faults
    told["weight"] = weight.to_json_dict()
    where = "where the loops are closed so" if closed else "at q = 0"
    return told, [*lines, "", *_weight_lines(weight, where)], warnings, faults


def _loop_lines(closed: dict[str, Any], stated: Mapping[str, float]) -> list[str]:
    def place(name: str, value: float) -> str:
        at = stated.get(name, value)  # loops that do not close there stand elsewhere
        return f"{name} = {value:.6g}" + (f" ([assembly] {at:g})" if abs(value - at) > 1e-6 else "")

    stand = ", ".join(place(name, value) for name, value in closed["assembled"].items())
    lines = [f"loops closed at {stand} [rad, m]"]
    if count := closed["redundant_conditions"]:
        lines.append(
            f"{count} conditions of the closures repeat others; their forces are taken as the smallest"
        )
    return lines


def _weight(arm: Arm, values: Mapping[str, float]) -> WeightStatement:
    """Return the weight of the arm with its effects; the core is loaded only if one changes weights."""
    if not any(effect.place in ("payload", "link", "base") for effect in arm.effects):
        from flexarm.arm.weight import weight_statement

        return weight_statement(arm, values=values)
    from flexarm.assembly.as_built import weight_as_built

    return weight_as_built(arm, values)


def _outline(arm: Arm) -> dict[str, Any]:
    from flexarm.arm.joint_units import parameters_in

    return {
        "name": arm.name,
        "gravity": list(arm.gravity),
        "joints": [joint.name for joint in arm.joints],
        "links": [link.name for link in arm.links],
        **({"closures": [closure.name for closure in arm.closures]} if arm.closures else {}),
        "payloads": [load.name for load in arm.payloads],
        "points": [point.name for point in arm.points],
        "uncertainty": dict(arm.uncertainty),
        "sensors": [sensor.name for sensor in arm.sensors],
        "effects": [
            {
                "name": effect.name,
                "at": effect.at,
                "parameters": [
                    {"name": name, "value": value, "unit": unit}
                    for name, value, unit in parameters_in(effect, arm)
                ],
            }
            for effect in arm.effects
        ],
    }


def _weight_lines(weight: WeightStatement, where: str) -> list[str]:
    lines = [
        f"weight {where}, in the base's frame; inertia about the own centre",
        f"  {'':20} {'mass [kg]':>10}   {'centre [m]':^27}   Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg m2]",
    ]
    rows: list[tuple[str, Body]] = [
        *((f"link {name}", body) for name, body in weight.links.items()),
        *((f"payload {name}", body) for name, body in weight.payloads.items()),
        ("whole", weight.whole),
    ]
    for name, body in rows:
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
        centre = ", ".join(f"{_small(x):.4f}".rjust(8) for x in body.centre)
        inertia = ", ".join(f"{_small(i):.5g}" for i in (xx, yy, zz, xy, xz, yz))
        lines.append(f"  {name:20} {body.mass:10.4f}   {centre}   {inertia}")
    return lines


def _small(value: float) -> float:
    """Return zero instead of rounding errors of rotations."""
    return 0.0 if abs(value) < 1e-12 else value


def _record(path: Path) -> Told:
    from flexarm.record import Record
    from flexarm.record.plausibility import unknown_motion

    record = Record.load(path)
    signals = {name: _signal(record, name) for name in record.signals}
    told = {
        "kind": "record",
        "description": record.description,
        "record_kind": record.kind,
        "duration": record.duration,
        "drive": list(record.drive),
        "payloads": {name: load.to_plain() for name, load in record.payloads.items()},
        "controllers": {name: dict(values) for name, values in record.controllers.items()},
        "links": {name: drawn.to_plain() for name, drawn in record.links.items()},
        "clocks": {name: clock.model_dump() for name, clock in record.clocks.items()},
        "frames": {name: frame.model_dump() for name, frame in record.frames.items()},
        "base": None if record.base is None else record.base.model_dump(),
        "signals": signals,
    }
    return told, record_lines(record), record.check(), unknown_motion(record)


def record_lines(record: Record) -> list[str]:
    """Return a record in lines for a person: its drive, clocks and frames, and each signal."""
    signals = {name: _signal(record, name) for name in record.signals}
    return [*_head(record), *map(_signal_line, signals.items())]


def _signal(record: Record, name: str) -> dict[str, Any]:
    signal = record.signals[name]
    stamped = len(signal.time) > 0
    return {
        "quantity": signal.quantity,
        "at": signal.place,
        "side": signal.side,
        "input": signal.input or None,
        "axes": list(signal.axes),
        "unit": signal.unit,
        "rows": len(signal),
        "rate_hz": signal.rate_hz if len(signal.time) > 1 else None,
        "start": float(signal.time[0]) if stamped else None,
        "end": float(signal.time[-1]) if stamped else None,
        "drop_outs": len(signal) - int(signal.valid.sum()),
        "noise_std": signal.noise_std,
        "clock": signal.clock,
        "frame": signal.frame,
    }


def _carried(load: CarriedPayload) -> str:
    """Return a text on a payload, with units."""
    said = []
    if load.mass is not None:
        said.append(f"{load.mass:g} kg")
    if load.inertia is not None:
        said.append(f"inertia {', '.join(f'{number:g}' for number in load.inertia)} kg m2")
    if load.position is not None:
        said.append(f"at {', '.join(f'{number:g}' for number in load.position)} m")
    return ", ".join(said) or "as in the model"


def _head(record: Record) -> list[str]:
    lines = [repr(record).strip("<>"), f"  drive: {', '.join(record.drive) or 'none'}"]
    lines += [f"  payload {name}: {_carried(load)}" for name, load in record.payloads.items()]
    lines += [f"  controller of {name}: {dict(values)}" for name, values in record.controllers.items()]
    lines += [f"  link {name}: drawn out to {drawn.length:g} m" for name, drawn in record.links.items()]
    for i, (name, clock) in enumerate(record.clocks.items()):
        known = (
            "reference"
            if i == 0
            else "unknown"
            if clock.unknown
            else f"{clock.offset:g} +- {clock.sigma:g} s"
        )
        lines.append(f"  clock {name}: {known}")
    for name, frame in record.frames.items():
        known = "unknown" if frame.unknown else f"+- {frame.translation:g} m, {frame.rotation:g} rad"
        lines.append(f"  frame {name}: {known}")
    if record.base is not None:
        x, y = record.base.tilt
        lines.append(f"  base: tilted by {x:g} rad about x, {y:g} rad about y, +- {record.base.sigma:g} rad")
    return lines


def _signal_line(entry: tuple[str, dict[str, Any]]) -> str:
    name, s = entry
    if not s["rows"]:  # no other signal is without values
        return f"  signal {name}: {s['quantity']} at {s['at']} [{s['unit']}], the input of responses"
    rate = f"{s['rate_hz']:.4g} Hz" if s["rate_hz"] else "poses"
    rate = f"response to {s['input']}" if s["input"] else rate
    noise = "not stated" if s["noise_std"] is None else f"{s['noise_std']:g}"
    lost = f", {s['drop_outs']} drop-outs" if s["drop_outs"] else ""
    return (
        f"  signal {name}: {s['quantity']} at {s['at']} [{s['unit']}], {s['rows']} rows, {rate}, "
        f"noise {noise}, clock {s['clock']}{lost}"
    )


def _superelement(path: Path) -> Told:
    from flexarm.superelement import SuperElement

    element = SuperElement.load(path)
    return {"kind": "superelement", **element.to_json_dict()}, [element.summary()], element.check(), []
