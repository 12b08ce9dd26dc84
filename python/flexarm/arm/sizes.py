"""Sizes unlike those of any machine: millimetres taken for metres, grams for kilograms, per cent for one.

Each limit is beyond what has been built, so that it doubts a typing error and no machine:

    length        `LONGEST`: concrete pumps reach some 100 m in several sections, the Space Station's arm 18 m
    sag           g rho A L^4/(8 E I) of a beam clamped level, over L: one that would hang down by more than
                  its length cannot be a link, whichever way it is clamped                            (1)
    modulus       `stiffest`: diamond has 1.2e12 Pa
    density       `densest`: osmium has 22 600 kg/m3
    payload       `HEAVIEST` times the links: on Earth arms carry about their weight at most, in orbit the
                  Space Station's moves 116 t with 1.5 t, 77 times its own
    inertia       of a payload, as if its mass were `widest` times as far from its centre as the arm reaches:
                  kg mm2 or kg cm2 for kg m2
    rotor         geared, `HEAVIEST` times all links and payloads at the reach of the arm, or moved along it:
                  kg cm2 or kg mm2 for kg m2
    sample time   K_p T >= 2 of a cascade: its position loop, x_{k+1} = (1 - K_p T) x_k at best, diverges
    turn          of a joint's frame by more than a turn: degrees for radians
    sensors       noise of a place a tenth of the reach of the arm, of an angle 0.2 rad; rate beyond
                  `quickest`, as strain gauges and IMUs are sampled at some ten kHz at most; jitter of a stamp
                  more than the time between samples; latency beyond `LATEST`: milliseconds meant
    uncertainty   1 sigma beyond the value itself, or, of a place, beyond the reach of the arm: values of no
                  meaning, such as negative masses, would be likely

(1), the sag of a cantilever in theory of small deflections, is that of the stiffer plane: a ruler that swings
on edge is stiff against gravity. Limits of materials are of tables, those of machines of their makers' data.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot, pi, sqrt
from typing import TYPE_CHECKING

from flexarm.arm.controller import Cascade
from flexarm.arm.link import Beam, RigidLink
from flexarm.arm.uncertainty import owner_of
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.sensor import Sensor

LONGEST = 100.0
"""Distance within one link, or from a joint to the frame that it stands in [m]."""
HEAVIEST = 100.0
"""Mass of a payload over that of all links."""


def reach(arm: Arm) -> float:
    """Return an upper bound of the distance from the base to any point [m]: the sum of all lengths."""
    lengths = [hypot(*joint.origin.xyz) for joint in arm.joints]
    lengths += [link.length for link in arm.links if isinstance(link, Beam)]
    offsets = [hypot(*point.position) for point in arm.points]
    return sum(lengths) + max(offsets, default=0.0)


def size_problems(arm: Arm) -> Iterable[Problem]:
    """Yield sizes beyond those of machines, sigmas beyond the sizes, and implausible sensors."""
    yield from implausible_sizes(arm)
    for key, sigma in arm.uncertainty.items():
        unit = owner_of(arm, key).unit
        if not unit and sigma > 1:
            yield Problem(
                f"uncertainty.{key}",
                f"is {100 * sigma:g} % of the value (1 sigma), so that even values below zero are likely; "
                "the number is relative, 2 % is 0.02",
            )
        elif unit == "m" and sigma > reach(arm):
            what = f"is {sigma:g} m (1 sigma), further than the arm reaches, {reach(arm):g} m"
            yield Problem(f"uncertainty.{key}", f"{what}; it is in m, not in mm")
    for sensor in arm.sensors:
        yield from sensor_problems(sensor, reach(arm))
    yield from _drives(arm)


def _drives(arm: Arm) -> Iterable[Problem]:
    """Yield rotors that outweigh the arm, and controllers that sample too slowly."""
    own = (mass_of_links(arm) or 0.0) + sum(load.mass for load in arm.payloads)
    for joint in arm.joints:
        geared, slides = joint.gear_ratio**2 * joint.rotor_inertia, joint.type == "prismatic"
        moved = own if slides else own * reach(arm) ** 2
        if mass_of_links(arm) and 0 < HEAVIEST * moved < geared:
            unit = "kg" if slides else "kg m2"
            yield Problem(
                f"joints.{joint.name}.rotor_inertia",
                f"is {joint.rotor_inertia:g} kg m2, at the output {geared:.3g} {unit}, "
                f"{geared / moved:.2g} times all links and payloads; inertias are in kg m2 on the motor side",
            )
    for controller in arm.controllers:
        if isinstance(controller, Cascade) and controller.position_gain * controller.sample_time >= 2:
            yield Problem(
                f"controllers.{controller.joint}.sample_time",
                f"is {controller.sample_time:g} s, so long that a position gain of "
                f"{controller.position_gain:g} 1/s diverges; it is in s, not in ms",
            )


def implausible_sizes(arm: Arm) -> Iterable[Problem]:
    """Yield lengths, beams and payloads that no machine has."""
    yield from _lengths(arm)
    for link in arm.links:
        if isinstance(link, Beam):
            yield from _beam(link, hypot(*arm.gravity))
    yield from _payloads(arm)
    for joint in arm.joints:
        if max(map(abs, joint.origin.rpy)) > 2 * pi:
            what = f"is {list(joint.origin.rpy)} rad; write degrees as radians"
            yield Problem(f"joints.{joint.name}.origin.rpy", what)


def _lengths(arm: Arm) -> Iterable[Problem]:
    places = {f"links.{link.name}.end": link.end for link in arm.links if isinstance(link, Beam)}
    places |= {f"links.{link.name}.com": link.com for link in arm.links if isinstance(link, RigidLink)}
    places |= {f"joints.{joint.name}.origin.xyz": joint.origin.xyz for joint in arm.joints}
    for where, place in places.items():
        if hypot(*place) > LONGEST:
            what = f"is {hypot(*place):g} m away, further than any arm reaches; lengths are in m, not in mm"
            yield Problem(where, what)


def _beam(link: Beam, gravity: float) -> Iterable[Problem]:
    stiffest, densest = 1.3e12, 2.3e4  # of materials [Pa], [kg/m3]
    material, section = link.material, link.section
    sag = gravity * material.density * section.area * link.length**3
    sag /= 8 * material.youngs_modulus * max(section.second_moments)  # eq. (1)
    if sag > 1 and link.length <= LONGEST:
        yield Problem(
            f"links.{link.name}",
            f"would hang down by {sag:.2g} times its length under its own weight if clamped level; "
            "are length [m], section [m] and material [Pa, kg/m3] in these units?",
        )
    if material.youngs_modulus > stiffest:
        what = f"is {material.youngs_modulus:g} Pa, stiffer than diamond; moduli are in Pa (steel 210e9)"
        yield Problem(f"links.{link.name}.material.youngs_modulus", what)
    if material.density > densest:
        what = f"is {material.density:g} kg/m3, denser than any metal; densities are in kg/m3 (steel 7850)"
        yield Problem(f"links.{link.name}.material.density", what)


def mass_of_links(arm: Arm) -> float | None:
    """Return the mass of all links [kg]; None if the model does not hold it, as with super-elements."""
    masses = [_mass(link) for link in arm.links if isinstance(link, Beam | RigidLink)]
    return sum(masses) if len(masses) == len(arm.links) else None


def _payloads(arm: Arm) -> Iterable[Problem]:
    """Yield payloads that are too heavy or too wide for their arm."""
    # Radius of gyration of a payload over the reach of the arm, and below which none is too large [m].
    widest, small = 3.0, 1.0
    own = mass_of_links(arm)
    for load in arm.payloads:
        if own and load.mass > HEAVIEST * own:
            what = f"is {load.mass:g} kg, {load.mass / own:.2g} times the mass of all links; masses are in kg"
            yield Problem(f"payloads.{load.name}.mass", what)
        radius = sqrt(max(load.inertia[:3]) / load.mass) if load.mass > 0 else 0.0
        if radius > max(widest * reach(arm), small):
            yield Problem(
                f"payloads.{load.name}.inertia",
                f"is that of {load.mass:g} kg at {radius:.3g} m from its centre, the arm reaches "
                f"{reach(arm):.3g} m; inertias are in kg m2",
            )


def _mass(link: Beam | RigidLink) -> float:
    if isinstance(link, Beam):
        return link.material.density * link.section.area * link.length
    return link.mass


LATEST = 10.0
"""Age of a value at its stamp [s]."""


def sensor_problems(sensor: Sensor, reach: float) -> Iterable[Problem]:
    """Yield implausible values of a sensor of an arm with this reach [m]."""
    quickest = 1e5  # samples a second [Hz]
    part, turned = 0.1, 0.2  # greatest noise of a place, over the reach; of an angle [rad]
    where = f"sensors.{sensor.name}"
    unit, factor = sensor.si
    noise = (sensor.noise_std or 0.0) * factor
    most = {"m": part * reach, "rad": turned}.get(unit, 0.0)
    if 0 < most < noise:
        what = f"is {noise:g} {unit} (1 sigma); it is in the unit of the sensor, {sensor.unit or unit}"
        yield Problem(f"{where}.noise_std", what)
    if sensor.rate_hz > quickest:
        yield Problem(f"{where}.rate_hz", f"is {sensor.rate_hz:g} Hz; no sensor of an arm samples so quickly")
    if sensor.jitter_std > 1 / sensor.rate_hz:
        what = f"is {sensor.jitter_std:g} s (1 sigma), samples are {1 / sensor.rate_hz:.3g} s apart"
        yield Problem(f"{where}.jitter_std", f"{what}; it is in s, not in ms")
    if sensor.latency_s > LATEST:
        yield Problem(f"{where}.latency_s", f"is {sensor.latency_s:g} s; it is in s, not in ms")
