"""Plausibility rules of models: values that are allowed and look wrong."""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arm.link import Beam, SuperElementLink
from flexarm.arm.names import link_of
from flexarm.arm.places import place_in_link
from flexarm.arm.rotation import added, dot, scaled
from flexarm.arm.section import General, contradiction
from flexarm.arm.sizes import size_problems
from flexarm.arm.urdf_beams import ENDS, left_from_end
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm


def validate(arm: Arm) -> Iterable[Problem]:
    """Yield implausible values of a model."""
    for link in arm.links:
        if isinstance(link, Beam):
            yield from _beam(link)
    yield from _beyond_the_beam(arm)
    yield from _on_the_start(arm)
    yield from _counted_twice(arm)
    yield from _unseen(arm)
    yield from assumed_axes(arm, "sensors", arm.sensors)
    yield from size_problems(arm)
    if not 9.5 < hypot(*arm.gravity) < 10 and hypot(*arm.gravity) > 0:
        yield Problem("gravity", f"has a magnitude of {hypot(*arm.gravity):g} m/s2; on Earth it is 9.81 m/s2")


def _beam(link: Beam) -> Iterable[Problem]:
    section = f"links.{link.name}.section"
    if isinstance(link.section, General):
        found = contradiction(link.section)
        if found:
            yield Problem(section, found)
        iy, iz = link.section.second_moments
        if (
            6.2832 * (iy + iz) < 0.999 * link.section.area**2
        ):  # a solid disc has the least: Iy + Iz = A^2 / (2 pi)
            yield Problem(
                section,
                f"no section of area {link.section.area:g} m2 has second moments as small as {iy:g} and "
                f"{iz:g} m4; their sum is at least {link.section.area**2 / 6.2832:.3g} m4",
            )
    width = max(link.section.second_moments) ** 0.25
    if width > link.length:
        what = f"the beam is {link.length:g} m long and about as thick; lengths are in m"
        yield Problem(f"links.{link.name}.end", what)
    modulus = link.material.youngs_modulus
    if modulus < 1e6:
        what = f"is {modulus:g} Pa, softer than rubber; moduli are in Pa (steel 210e9)"
        yield Problem(f"links.{link.name}.material.youngs_modulus", what)
    if 0 < link.material.density < 50:
        what = f"is {link.material.density:g} kg/m3; densities are in kg/m3 (steel 7850)"
        yield Problem(f"links.{link.name}.material.density", what)


def _beyond_the_beam(arm: Arm) -> Iterable[Problem]:
    """Yield payloads and points whose projection lies outside their beam."""
    beyond = 2e-3  # part of a beam's length by which a refined place may reach beyond its end
    beams = {link.name: link for link in arm.links if isinstance(link, Beam)}
    for table in ("payloads", "points"):
        for entry in getattr(arm, table):
            beam = beams.get(link_of(entry.link))
            if beam is None:
                continue
            along = sum(p * e for p, e in zip(entry.position, beam.end, strict=True)) / beam.length
            if not -beyond * beam.length <= along <= beam.length * (1 + beyond):
                yield Problem(
                    f"{table}.{entry.name}.position",
                    f"projects to {along:g} m along link {beam.name!r}, which reaches from 0 to "
                    f"{beam.length:g} m; it sits rigidly on the nearer end",
                )


def _on_the_start(arm: Arm) -> Iterable[Problem]:
    """Yield joints without `at` that stand along a beam and are rigid with its start."""
    beams = {link.name: link for link in arm.links if isinstance(link, Beam)}
    for joint in arm.joints:
        beam = beams.get(joint.parent)
        if beam is None or "at" in joint.model_fields_set:
            continue
        along = dot(joint.origin.xyz, beam.end) / beam.length / beam.length
        if along <= ENDS:
            continue
        if along >= 1 - ENDS:
            rest = [float(f"{part:.9g}") for part in left_from_end(joint.origin.xyz, beam.end)]
            where, write = "at its far end", f'at = "end" and origin xyz = {rest}'
        else:
            where = f"{along * beam.length:.4g} m along it"
            write = "two beams that meet there"
        yield Problem(
            f"joints.{joint.name}.at",
            f"is left out: the joint is rigid with the start of beam {beam.name!r} and stands {where}, which "
            f'it does not follow; write {write}, or at = "start"',
        )


def _unseen(arm: Arm) -> Iterable[Problem]:
    """Yield effects at signals, clocks and frames that no sensor of the model has; records may have them."""
    if not arm.sensors:
        return
    signals = [sensor.name for sensor in arm.sensors]
    signals += [joint.name for joint in arm.moving_joints if joint.name not in signals]  # drives are signals
    clocks = list(dict.fromkeys(sensor.clock or "clock" for sensor in arm.sensors))
    known = {
        "signal": signals,
        "signal or clock": [*signals, *clocks],
        "frame": list(dict.fromkeys(["base", *(sensor.frame for sensor in arm.sensors)])),
    }
    for effect in arm.effects:
        if effect.place in known and effect.at not in known[effect.place]:
            have = ", ".join(known[effect.place])
            yield Problem(
                f"effects.{effect.name}.{effect.at}",
                f"no sensor has the {effect.place} {effect.at!r}, they have {have}; the effect acts only on "
                "a record that has it",
            )


def assumed_axes(arm: Arm, table: str, gauges: Iterable[Any]) -> Iterable[Problem]:
    """Yield strain gauges of a table off the axis of a beam without `up`, which gives the section's axes."""
    beams = {link.name: link for link in arm.links if isinstance(link, Beam) and link.up is None}
    for gauge in gauges:
        beam = beams.get(gauge.link or "")
        if gauge.quantity == "strain" and beam is not None and any(gauge.fibre or ()):
            z = "xyz"[beam.lean.index(1.0)]
            what = f"counts in section axes whose z leans to {z} of the link: {beam.name!r} states no `up`"
            yield Problem(f"{table}.{gauge.name}.fibre", what)


def _counted_twice(arm: Arm) -> Iterable[Problem]:
    """Yield positions on a super-element that repeat the position of its interface, from which they count."""
    parts = {
        link.name for link in arm.links if isinstance(link, SuperElementLink) and Path(link.file).is_file()
    }
    for table, entries in (("payloads", arm.payloads), ("points", arm.points)):
        for entry in entries:
            if link_of(entry.link) not in parts:
                continue
            _, position = place_in_link(arm, entry.link)
            if hypot(*position) > 0 and hypot(*added(entry.position, scaled(-1.0, position))) < 1e-6:
                yield Problem(
                    f"{table}.{entry.name}.position",
                    f"is {list(entry.position)}, as the interface's own in its part; it counts from the "
                    f"interface {entry.link!r}, where [0, 0, 0] is",
                )
