"""An arm told in a few lines, for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.arm.joint_units import parameters_in
from flexarm.arm.link import Beam, Link, RigidLink
from flexarm.arm.uncertainty import owner_of

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.effect import Effect


def summary(arm: Arm) -> str:
    """Return lines on joints, links, payloads, effects and uncertain values."""
    lines = [repr(arm).strip("<>")]
    for joint in arm.joints:
        ratio = f", ratio {joint.gear_ratio:g}" if joint.gear_ratio != 1 else ""
        lines.append(f"  joint {joint.name}: {joint.type}, {joint.parent} -> {joint.child}{ratio}")
    lines += [f"  gear {gear.name}: {gear.input} = {gear.ratio:g} x {gear.output}" for gear in arm.gears]
    lines += [f"  closure {each.name}: {each.type}, {each.a} - {each.b}" for each in arm.closures]
    lines += [f"  link {link.name}: {_link(link)}" for link in arm.links]
    lines += [f"  payload {load.name}: {load.mass:g} kg on {load.link}" for load in arm.payloads]
    lines += [f"  effect {_effect(arm, effect)}" for effect in arm.effects]
    if arm.sensors:
        lines.append(f"  sensors: {', '.join(f'{s.name} ({s.quantity})' for s in arm.sensors)}")
    lines += [f"  uncertain: {_uncertain(arm, key, sigma)}" for key, sigma in arm.uncertainty.items()]
    return "\n".join(lines)


def _effect(arm: Arm, effect: Effect) -> str:
    """Return a line on an effect in the units of its joint."""
    here = parameters_in(effect, arm)
    return str(effect) if here == effect.parameters() else effect.told(here)


def _uncertain(arm: Arm, key: str, sigma: float) -> str:
    """Return a nominal value and 1 sigma of it, in its unit or relative."""
    place = owner_of(arm, key)
    value = ".".join((*place.prefix, place.field))
    return (
        f"{value} +- {sigma:g} {place.unit} (1 sigma)"
        if place.unit
        else f"{value} +- {100 * sigma:g} % (1 sigma)"
    )


def _link(link: Link) -> str:
    if isinstance(link, Beam):
        return (
            f"beam, {link.length:g} m, {link.section.shape}, E = {link.material.youngs_modulus / 1e9:g} GPa, "
            f"{link.theory}, {link.elements} elements"
        )
    return f"rigid, {link.mass:g} kg" if isinstance(link, RigidLink) else f"super-element from {link.file}"
