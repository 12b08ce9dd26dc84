"""Compatibility of a record with a model: unknown names, values that the arm cannot show."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.attachment import Payload
from flexarm.arm.closure import joints_moved_with
from flexarm.arm.consistency import missing
from flexarm.arm.effect import read_effect
from flexarm.arm.link import Beam
from flexarm.arm.plausibility import assumed_axes
from flexarm.arm.rotation import scaled
from flexarm.errors import InvalidParameter, Problem
from flexarm.record.drive_span import range_at_rest
from flexarm.record.frame_plausibility import frame_problems
from flexarm.record.payload_plausibility import payload_problems
from flexarm.record.plausibility import is_remote
from flexarm.record.time_unit import implausible_rates
from flexarm.record.workspace import predicted_places, workspace_radius

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal
    from flexarm.record.table import DrawnLink


def unknown_names(record: Record, arm: Arm) -> list[Problem]:
    """Return joints, points, links and payloads that the model does not have."""
    known = {
        "joint": [joint.name for joint in arm.moving_joints],
        "point": [point.name for point in arm.points],
        "link": [link.name for link in arm.links],
        "payload": [load.name for load in arm.payloads],
        "controller": [controller.joint for controller in arm.controllers],
    }
    found = [
        Problem(f"signals.{signal.name}.{kind}", missing(kind, place, names))
        for signal in record.signals.values()
        for kind, names in known.items()
        if (place := getattr(signal, kind, None)) is not None and place not in names
    ]
    found += [
        Problem(f"joints.{name}", missing("joint", name, known["joint"]))
        for name in record.joints
        if name not in known["joint"]
    ]
    return found + [
        Problem(f"{kind}s.{name}", missing(kind, name, known[kind]))
        for kind, named in (
            ("payload", record.payloads),
            ("link", record.links),
            ("controller", record.controllers),
        )
        for name in named
        if name not in known[kind]
    ]


def validate(record: Record, arm: Arm) -> list[Problem]:
    """Return values that this arm cannot show, effects that act on nothing, and gauges on assumed axes."""
    return [
        *implausible_values(record, arm),
        *unplaced_effects(record, arm),
        *assumed_axes(arm, "signals", record.signals.values()),
    ]


def implausible_values(record: Record, arm: Arm) -> list[Problem]:
    """Return values that this arm cannot show, as they stand in the record."""
    if record.kind == "frequency_response":
        return []
    shafts = {gear.input for gear in arm.gears}
    return [
        *_positions(record, arm),
        *_angles(record, arm),
        *_undriven(record, arm),
        *implausible_rates(record, [joint.name for joint in arm.moving_joints if joint.name not in shafts]),
        *frame_problems(record, arm),
        *payload_problems(record, arm),
    ]


def unplaced_effects(record: Record, arm: Arm) -> list[Problem]:
    """Return effects of the model at signals, clocks and frames that the record has not.

    One model serves several records, so this is a warning and no error.
    """
    known = {
        "signal": list(record.signals),
        "signal or clock": [*record.signals, *record.clocks],
        "frame": ["base", *record.frames],
    }
    return [
        Problem(
            f"effects.{effect.name}.{effect.at}",
            f"acts on nothing in this record: {missing(effect.place, effect.at, known[effect.place])}",
        )
        for effect in arm.effects
        if effect.place in known and effect.at not in known[effect.place]
    ]


def with_units_of(record: Record, arm: Arm) -> Record:
    """Return the record with metres and newtons at joints that slide, where it states no unit."""
    sliding = {joint.name for joint in arm.joints if joint.type == "prismatic"}
    known = {
        name: signal.replace(unit=signal.spec.units[-1], unit_assumed=False)
        for name, signal in record.signals.items()
        if signal.unit_assumed and signal.joint in sliding and not signal.input
    }
    return record.replace(signals={**record.signals, **known}) if known else record


def with_encoders(arm: Arm, records: Iterable[Record]) -> Arm:
    """Return the arm that knows which encoders of the records measure joints that slide."""
    sliding = {joint.name for joint in arm.joints if joint.type == "prismatic"}
    found = {
        name: signal.joint
        for record in records
        for name, signal in record.signals.items()
        if signal.quantity == "joint_angle" and signal.joint in sliding - {name}
    }
    return arm.replace(encoders={**found, **arm.encoders}) if found else arm


def with_overrides(record: Record, arm: Arm) -> Arm:
    """Return the arm with the payloads, lengths, controllers and tilt of the base of a run."""
    arm = with_link_lengths(_set(arm, record), record.links)
    if record.base is not None:
        arm = arm.with_effect(read_effect({"name": "base_tilt", "at": "base", "angle": record.base.tilt}))
    if not record.payloads:
        return arm
    loads = {load.name: load for load in arm.payloads}
    for name, carried in record.payloads.items():
        if name not in loads:
            raise InvalidParameter(missing("payload", name, loads), where=f"payloads.{name}")
        loads[name] = loads[name].replace(**carried.to_plain())
    weighed = {name for name, carried in record.payloads.items() if carried.mass is not None}
    return _loaded(arm, loads.values(), weighed)


def _set(arm: Arm, record: Record) -> Arm:
    """Return the arm with its controllers as they were set in a run."""
    own = {controller.joint: controller for controller in arm.controllers}
    for joint, values in record.controllers.items():
        if joint not in own:
            raise InvalidParameter(missing("controller", joint, own), where=f"controllers.{joint}")
        settable = sorted(set(type(own[joint]).model_fields) - {"type", "joint", "deflection"})
        for key in values:
            if key not in settable:
                raise InvalidParameter(missing("value", key, settable), where=f"controllers.{joint}.{key}")
        own[joint] = own[joint].replace(**values)
    return arm.replace(controllers=tuple(own.values())) if record.controllers else arm


def with_payload_masses(arm: Arm, masses: Mapping[str, float]) -> Arm:
    """Return the arm with payload masses [kg] by name, which replace effects `payload_mass` there."""
    if not masses:
        return arm
    loads = (load.replace(mass=masses[load.name]) if load.name in masses else load for load in arm.payloads)
    return _loaded(arm, loads, masses)


def _loaded(arm: Arm, loads: Iterable[Payload], weighed: Container[str]) -> Arm:
    """Return an arm with other payloads, without effects on masses that were weighed.

    A share of nothing is no uncertainty: it goes where the mass is 0.
    """
    loads = tuple(loads)
    empty = {f"payloads.{load.name}.mass" for load in loads if load.mass == 0}
    return arm.replace(
        payloads=loads,
        effects=tuple(e for e in arm.effects if not (e.name == "payload_mass" and e.at in weighed)),
        uncertainty={key: sigma for key, sigma in arm.uncertainty.items() if key not in empty},
    )


def _positions(record: Record, arm: Arm) -> Iterable[Problem]:
    seen = [signal for signal in record.of_quantity("position").values() if signal.valid.any()]
    if arm.closures:  # where joints that follow stand is not known here
        return
    limit = workspace_radius(record, arm) if seen else 0.0
    for signal in seen if limit else []:
        span = float(np.max(np.nanmax(signal.values, axis=0) - np.nanmin(signal.values, axis=0)))
        far = float(np.nanmax(np.abs(signal.values)))
        own = is_remote(record.frame_of(signal))
        value, what = (span, "moves over") if own else (far, "reaches")
        if value > 10 * limit:
            yield Problem(
                f"signals.{signal.name}",
                f"{what} {value:g} m, the arm reaches {limit:g} m at most; "
                'if the file holds millimetres, say unit = "mm"',
            )
        elif len(signal.axes) == 3:
            yield from _too_small(record, arm, signal, span, None if own else far)


def _too_small(record: Record, arm: Arm, signal: Signal, span: float, far: float | None) -> Iterable[Problem]:
    """Yield positions much nearer to the base, or that move much less, than those of the rigid arm.

    A turn of the frame leaves at least 1/sqrt(3) of a motion along one of its axes.
    """
    drives = [record.signals[name] for name in record.drive]
    told = bool(drives) and all(s.quantity == "joint_angle" and s.valid.any() for s in drives)
    places = predicted_places(record, arm, signal)
    away = min(float(np.max(np.linalg.norm(place, axis=1))) for place in places)
    rigid = min(float(np.max(np.ptp(place, axis=0))) for place in places)
    if far is not None and 200 * far < away:
        what = f"stays within {far:.3g} m of the base, a rigid arm would have it {away:.3g} m away"
    elif told and 100 * span < rigid:
        what = f"moves over {span:.3g} m, a rigid arm would move over {rigid:.3g} m"
    else:
        return
    yield Problem(f"signals.{signal.name}", f"{what}; is the unit right?")


def _undriven(record: Record, arm: Arm) -> Iterable[Problem]:
    """Yield encoders of motors that move while nothing drives their joint: the model holds it."""
    if record.kind != "motion" or not record.drive:
        return
    driven = {str(record.signals[name].joint) for name in record.drive}
    driven |= {controller.joint for controller in arm.controllers}
    driven = driven.union(*(joints_moved_with(arm, joint) for joint in driven))
    for signal in record.of_quantity("joint_angle").values():
        seen = signal.values[signal.valid, 0]
        moves = len(seen) > 0 and float(np.ptp(seen)) > range_at_rest(signal)
        if signal.side == "motor" and signal.joint not in driven and moves:
            yield Problem(
                f"signals.{signal.name}",
                f"is a motor's angle and moves, but is not in drive: the model holds {signal.joint!r} still",
            )


def _angles(record: Record, arm: Arm) -> Iterable[Problem]:
    for signal in record.signals.values():
        if signal.joint is None or signal.quantity not in ("joint_angle", "joint_rate", "joint_command"):
            continue
        prismatic = arm.joint(signal.joint).type == "prismatic"
        if prismatic != signal.unit.startswith("m") and not signal.unit_assumed:
            wanted = "m" if prismatic else "rad"
            yield Problem(
                f"signals.{signal.name}.unit",
                f"is {signal.unit}, but joint {signal.joint!r} is "
                f"{arm.joint(signal.joint).type} and needs a unit like {wanted}",
            )


def with_link_lengths(arm: Arm, links: Mapping[str, DrawnLink]) -> Arm:
    """Return the arm with links of the lengths L that a record states for those of the model, L_0.

        error <- error + L - L_0,    u <- u (L/L_0)^2                                                    (1)

    The effect `link_length` of that error carries the change: section and material stay, payloads and points
    keep their fraction of the length, joints with `at = "end"` follow. The tip offset u of a bow belongs to
    the model's length; its curvature 2 u/L^2 is the boom's own and stays. Derivatives by u are those by the
    offset of the boom as it was drawn out; those by all other parameters mean the model's.

    Raise InvalidParameter if there is no such link, or it is no beam.
    """
    known = {link.name: link for link in arm.links}
    for name, drawn in links.items():
        if name not in known:
            raise InvalidParameter(missing("link", name, known), where=f"links.{name}")
        link = known[name]
        if not isinstance(link, Beam):
            what = f"must be a beam to have a length, {name!r} is a {link.type} link"
            raise InvalidParameter(what, where=f"links.{name}.length")
        own, bow = arm.effect("link_length", name), arm.effect("link_bow", name)
        error = float(getattr(own, "error", 0.0)) + drawn.length - link.length
        arm = arm.with_effect(read_effect({"name": "link_length", "at": name, "error": error}))
        if bow is not None:
            tip_offset = scaled((drawn.length / link.length) ** 2, bow.tip_offset)  # type: ignore[attr-defined]
            arm = arm.with_effect(bow.replace(tip_offset=tip_offset))  # eq. (1)
    return arm
