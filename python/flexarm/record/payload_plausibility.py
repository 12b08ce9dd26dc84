"""Plausibility rules of payloads, link lengths and joint values that a record states.

Grams for kilograms, millimetres for metres, degrees for radians. The model with what the run carried is
doubted as any model is (`flexarm.arm.plausibility`), and a load of `more` times the nominal arm with its
own loads besides: one in grams is a thousand times too heavy, and no arm carries loads so unlike one another,
but in orbit, where nothing weighs.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.joint import shaft_ratio
from flexarm.arm.link import Beam
from flexarm.arm.plausibility import validate as validate_arm
from flexarm.arm.sizes import LONGEST, mass_of_links
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record

DRAWN = 20.0
"""Length of a beam that was drawn out over the nominal one: telescopes have some five sections."""


def payload_problems(record: Record, arm: Arm) -> Iterable[Problem]:
    """Yield implausible loads, lengths and angles that a record states."""
    of_loads = list(_as_model(record, arm))
    yield from of_loads
    known = {problem.where for problem in of_loads}
    yield from (problem for problem in _heavy(record, arm) if problem.where not in known)
    lengths = {link.name: link.length for link in arm.links if isinstance(link, Beam)}
    for name, drawn in record.links.items():
        nominal = lengths.get(name, drawn.length)
        if drawn.length > min(LONGEST, DRAWN * nominal):
            what = f"is {drawn.length:g} m, the model has {nominal:g} m; lengths are in m, not in mm"
            yield Problem(f"links.{name}.length", what)
    yield from _standing(record, arm)


def _as_model(record: Record, arm: Arm) -> Iterable[Problem]:
    """Yield implausible payloads of the model as configured in the run, unless the model has them too."""
    if not record.payloads:
        return
    carried = record.replace(links={}, controllers={}).applied_to(arm)
    own = {problem.where for problem in validate_arm(arm)}
    for problem in validate_arm(carried):
        if problem.where.split(".")[0] == "payloads" and problem.where not in own:
            yield problem


def _heavy(record: Record, arm: Arm) -> Iterable[Problem]:
    more = 30.0  # mass of a load over that of the nominal arm with its loads
    links = mass_of_links(arm)
    own = {load.name: load.mass for load in arm.payloads}
    stated = [(f"payloads.{n}.mass", n, load.mass) for n, load in record.payloads.items() if load.mass]
    stated += [
        (f"signals.{signal.name}", str(signal.payload), float(np.nanmax(signal.values)))
        for signal in record.of_quantity("payload_mass").values()
        if signal.valid.any()
    ]
    whole = links + sum(own.values()) if links else 0.0
    for where, name, mass in stated:
        if whole > 0 and mass > more * whole and any(arm.gravity):
            nominal = f"the model has {own[name]:g} kg there and weighs {whole:.3g} kg in all"
            yield Problem(where, f"is {mass:g} kg, {nominal}; masses are in kg, not in g")


def _standing(record: Record, arm: Arm) -> Iterable[Problem]:
    """Yield angles of several turns behind gears, and slides further than any arm reaches."""
    for name, value in record.joints.items():
        slides = arm.joint(name).type == "prismatic"
        if slides and abs(value) > LONGEST:
            yield Problem(f"joints.{name}", f"is {value:g} m; lengths are in m, not in mm")
        elif not slides and abs(value) > 2 * pi * shaft_ratio(name, arm.gears):
            what = f"is {value:g} rad, {abs(value) / (2 * pi):.1f} turns; write degrees as radians"
            yield Problem(f"joints.{name}", what)
