"""An equilibrium in lines for a person and as a dictionary for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flexarm.arrays import Floats

if TYPE_CHECKING:
    from flexarm.statics.statics import Statics


def summary(found: Statics) -> str:
    """Return the result in lines that a person reads."""
    lines = [f"equilibrium of {found.arm.name} under gravity {list(found.arm.gravity)} m/s2"]
    if found.points:
        lines.append(f"{'point':<16}{'x [m]':>12}{'y [m]':>12}{'z [m]':>12}{'moved [mm]':>34}")
    else:
        lines.append("no points: the model has no [[points]] whose position and sag could be told")
    for i, name in enumerate(found.points):
        where = "".join(f"{_fixed(value, 6):>12}" for value in found.position[i])
        moved = _text(1e3 * found.displacement[i])
        lines.append(f"{name:<16}{where}{moved:>34}")
    slides = any(joint.type == "prismatic" for joint in found.arm.joints)
    angle, torque = ("[rad, m]", "[N m, N]") if slides else ("[rad]", "[N m]")
    lines.append(f"{'joint':<16}{f'drive {angle}':>16}{f'link {angle}':>16}{f'torque {torque}':>18}")
    for i, name in enumerate(found.joints):
        lines.append(
            f"{name:<16}{found.drive_angle[i]:16.8f}{found.link_angle[i]:16.8f}"
            f"{_fixed(found.joint_torque[i], 5):>18}"
        )
    beams = "beam" if any(link.type == "beam" for link in found.arm.links) else ""
    lines.append(f"{beams:<16}{'N, Vy, Vz [N]':>36}{'T, My, Mz [N m]':>36}")
    for i, link in enumerate(found.arm.links):
        for k, end in enumerate(("start", "end") if link.type == "beam" else ()):
            force, moment = _text(found.section_forces[i, k, :3]), _text(found.section_forces[i, k, 3:])
            lines.append(f"{link.name + ' ' + end:<16}{force:>36}{moment:>36}")
    for name, wrench in _closures(found).items():
        force, moment = _text(wrench[:3]), _text(wrench[3:])
        lines.append(f"{name:<16}{force:>36}{moment:>36}   closure, on its link b, base axes")
    if found.solver.get("redundant_conditions"):
        lines.append(
            f"{found.solver['redundant_conditions']} conditions of the closures repeat others, as in flat "
            "loops of rigid links; of the forces that fit, the smallest are told"
        )
    force, moment = _text(found.base_wrench[:3]), _text(found.base_wrench[3:])
    lines.append(f"{'on the base':<16}{force:>36}{moment:>36}   about its origin, base axes")
    return "\n".join(lines)


def to_json_dict(found: Statics) -> dict[str, Any]:
    """Return the object of `flexarm static --json`."""
    beams = [(i, link.name) for i, link in enumerate(found.arm.links) if link.type == "beam"]
    ends = ("start", "end")
    closures = _closures(found)
    return {
        "points": {
            name: {"position": found.position[i].tolist(), "displacement": found.displacement[i].tolist()}
            for i, name in enumerate(found.points)
        },
        "joints": {
            name: {
                "torque": float(found.joint_torque[i]),
                "drive_angle": float(found.drive_angle[i]),
                "link_angle": float(found.link_angle[i]),
            }
            for i, name in enumerate(found.joints)
        },
        "links": {
            name: {end: _wrench(found.section_forces[i, k]) for k, end in enumerate(ends)}
            for i, name in beams
        },
        **({"closures": {name: _wrench(w) for name, w in closures.items()}} if closures else {}),
        "base": _wrench(found.base_wrench),
        "solver": found.solver,
    }


def _closures(found: Statics) -> dict[str, Floats]:
    """Return force and moment of each closure."""
    if found.closure_force is None:
        return {}
    names = [closure.name for closure in found.arm.closures]
    return dict(zip(names, found.closure_force, strict=True))


def _text(values: Floats) -> str:
    return ", ".join(_fixed(value, 4) for value in values)


def _fixed(value: float, digits: int) -> str:
    """Return a number with so many decimals; what rounds to zero has no sign."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"


def _wrench(values: Floats) -> dict[str, list[float]]:
    return {"force": values[:3].tolist(), "moment": values[3:].tolist()}
