"""Strain gauges and deflection sensors on a bent link.

    strain     eps = N/EA + z M_y/EI_y - y M_z/EI_z        of the fibre (y, z) of a section          (1)
    deflection d = R_L^T (p - p_0)                         of a point p of the link                  (2)

N, M_y, M_z are section forces in the section's axes (tension positive, moments on the nearer part); along the
link they follow from those at its two ends, M' from the shear forces (M_y' = V_z, M_z' = -V_y) and N from
N'' = -rho A |w x e|^2, with w the angular rate of the link and e its axis, which is exact for loads that
change linearly along it. R_L holds the axes and p_0 is the place that link and point would have if the link
were rigid, at the simulated angle of its joint. EI, rho A, places and the base are those of the arm with its
effects.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arm.kinematics import chain_to, joint_frame, link_pose
from flexarm.arm.names import link_of
from flexarm.arrays import Floats
from flexarm.assembly.as_built import as_built
from flexarm.assembly.machine import machine_of, tilted
from flexarm.measurement.sampling import CannotMeasure, Described, columns, sample, stored
from flexarm.measurement.tracker import base_position


def strain(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the strain (1) of a fibre [-], shape (n, 1); needs `simulate(..., forces=True)`."""
    arm = simulation.arm
    link = arm.link(what.link)
    if link.type != "beam" or what.position is None or what.fibre is None:
        raise CannotMeasure(
            f"signal {what.name!r}: strain needs a beam, a position and a fibre, got the "
            f"{link.type} {link.name!r}, {what.position} and {what.fibre}"
        )
    if inside := _loaded_between_ends(arm, link):
        raise CannotMeasure(
            f"signal {what.name!r}: strain follows from the forces at both ends of a beam; between those of "
            f"{link.name!r} {', '.join(inside)} acts; make it two beams, with a fixed joint in between"
        )
    forces = stored(simulation, "section_forces", what).reshape(len(simulation.time), len(arm.links), 2, 6)
    ends = forces[:, [each.name for each in arm.links].index(link.name)]
    member = machine_of(arm).links[link.name]
    built: float = member.table.length  # type: ignore[union-attr]
    rho_A = member.mass_scale * link.material.density * link.section.area
    load_slope = rho_A * _axis_rate(simulation, link, what)
    normal, m_y, m_z = _along(ends, load_slope, float(what.position) * built / link.length, built)
    y, z = what.fibre
    i_y, i_z = link.section.second_moments
    bending = (z * m_y / i_y - y * m_z / i_z) / member.bending_scale
    eps = (normal / link.section.area + bending) / link.material.youngs_modulus  # eq. (1)
    return sample(simulation.time, eps[:, None], instants)


def _loaded_between_ends(arm: Any, link: Any) -> list[str]:
    """Return the payloads and closures that act on a beam between its ends."""
    axis, rounding = np.asarray(link.end) / link.length, 1e-6 * link.length
    places = [(load.name, load.position) for load in arm.payloads if load.link == link.name]
    for closure in arm.closures:
        sides = ((closure.a, closure.a_at, closure.a_origin), (closure.b, closure.b_at, closure.b_origin))
        places += [(closure.name, at.xyz) for on, end, at in sides if (on, end) == (link.name, "start")]
    return [name for name, place in places if rounding < axis @ np.asarray(place) < link.length - rounding]


def _axis_rate(simulation: Any, link: Any, what: Described) -> Floats:
    """Return |w x e|^2 of the undeformed link at the joints' angles and rates [rad2/s2], shape (n,)."""
    arm = simulation.arm
    angle, rate = stored(simulation, "joint_angle", what), stored(simulation, "joint_rate", what)
    column = {name: j for j, name in enumerate(simulation.joints)}
    values = {name: angle[:, j] for name, j in column.items()}
    spin = np.zeros((len(angle), 3))
    for joint in chain_to(arm, link.name):
        if joint.type == "revolute":
            frame = joint_frame(arm, joint, link_pose(arm, joint.parent, values))
            axis = np.asarray(joint.axis) / np.linalg.norm(joint.axis)
            spin = spin + rate[:, column[joint.name], None] * (frame.R @ axis)
    along = link_pose(arm, link.name, values).R @ (np.asarray(link.end) / link.length)
    squared: Floats = (np.cross(spin, along) ** 2).sum(axis=1)
    return squared


def _along(ends: Floats, load_slope: Floats, x: float, length: float) -> tuple[Floats, Floats, Floats]:
    """Return N (quadratic, N'' = -load_slope), M_y, M_z (cubic) at x of the link from its ends (n, 2, 6)."""
    if not 0 <= x <= length:
        raise CannotMeasure(f"a strain gauge must sit on its link, 0 to {length:g} m, got position {x:g} m")
    s = x / length
    start, end = ends[:, 0], ends[:, 1]

    def cubic(moment: int, slope: int, sign: float) -> Floats:
        return (
            (1 + 2 * s) * (1 - s) ** 2 * start[:, moment]
            + s**2 * (3 - 2 * s) * end[:, moment]
            + sign * length * (s * (1 - s) ** 2 * start[:, slope] - s**2 * (1 - s) * end[:, slope])
        )

    normal = (1 - s) * start[:, 0] + s * end[:, 0] + load_slope * x * (length - x) / 2
    return normal, cubic(4, 2, 1.0), cubic(5, 1, -1.0)


def deflection(simulation: Any, what: Described, instants: Floats) -> Floats:
    """Return the deflection (2) in the link's axes [m], shape (n, axes)."""
    arm, point, base = rigid_reference(simulation.arm, what)
    angle, rate = stored(simulation, "joint_angle", what), stored(simulation, "joint_rate", what)
    theta = sample(simulation.time, angle, instants, rate)
    values = {name: theta[:, j] for j, name in enumerate(simulation.joints)}
    frame = link_pose(arm, link_of(point.link), values, base)
    rigid = link_pose(arm, point.link, values, base).of_point(np.asarray(point.position))
    position = base_position(simulation, what, instants, point.name)
    offset: Floats = np.einsum("nji,nj->ni", frame.R, position - rigid)  # eq. (2)
    return offset[:, columns(what.axes)]


def rigid_reference(model: Any, what: Described) -> tuple[Any, Any, Any]:
    """Return the arm with its effects, the point whose deflection is measured, and the rotation of the base.

    Raise CannotMeasure if the frame of the undeformed link is not known from joint angles alone.
    """
    machine = machine_of(model)
    arm = as_built(machine)
    point = arm.point(_point(model, what).name)
    link = link_of(point.link)
    if machine.base.hinges:
        raise CannotMeasure(
            f"signal {what.name!r}: the deflection of {link!r} is measured from a frame that stands on a "
            "compliant base (effect base_compliance); the base must be rigid"
        )
    for joint in chain_to(arm, link):
        if machine.mounts[joint.name]:
            raise CannotMeasure(
                f"signal {what.name!r}: the deflection of {link!r} is measured from a frame beyond the soft "
                f"bearing of {joint.name!r} (a compliance across its axis), which nothing measures"
            )
        if joint.at == "end" or ":" in joint.parent:
            raise CannotMeasure(
                f"signal {what.name!r}: the deflection of {link!r} is measured from a frame "
                f"that stands on the flexible {joint.parent!r}; its parent must be rigid"
            )
    return arm, point, tilted(machine.base)


def _point(arm: Any, what: Described) -> Any:
    """Return the point of the signal: the named one, or the one on the link's axis at `position`."""
    if what.point is not None:
        return arm.point(what.point)
    link = arm.link(what.link)
    along = np.asarray(link.end) / link.length if link.type == "beam" else None
    for point in arm.points:
        if (
            along is not None
            and point.link == link.name
            and what.position is not None
            and np.allclose(point.position, what.position * along, atol=1e-9)
        ):
            return point
    raise CannotMeasure(
        f"signal {what.name!r}: the model has no point on the axis of {what.link!r} at "
        f"{what.position} m; give it one, or name a point in the signal"
    )
