"""Results of an equilibrium: positions of points, torques, section forces, shapes of parts."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import takes
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.pictures import drawn, viewed
from flexarm.result import Result
from flexarm.sensitivity import Sensitivities
from flexarm.statics.part_shape import PartShape

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.netcdf import Contents
    from flexarm.viewer import View


@dataclass(frozen=True, eq=False, repr=False)
class Statics(Result):
    """An equilibrium. Arrays are read-only.

    Attributes
    ----------
    arm : Arm
        The model.
    position, displacement : ndarray, shape (point, 3)
        Where the points are, base axes, and how far from the rigid arm at the same drive angles [m].
    rotation : ndarray, shape (point, 3, 3)
        Body axes at the points as columns, base axes.
    joint_torque, drive_angle, link_angle : ndarray, shape (joint,)
        Torque on the child about +axis, output side [N m], and angles of drive and link [rad].
    section_forces : ndarray, shape (link, 2, 6)
        (N, Vy, Vz, T, My, Mz) at start and end of each beam, section axes; NaN for rigid links [N, N m].
    base_wrench : ndarray, shape (6,)
        Force and moment that the arm puts on the base about its origin, base axes [N, N m].
    solver : dict
        Backend, iterations, load steps, largest unbalanced force left.
    parts : dict of str to PartShape
        Where each super-element is and how it is deformed.
    force : ndarray, shape (point, 3), or None
        Forces at the points, base axes [N]; None where there were none.
    at_link : tuple of str
        Joints whose drive angle is the link's.
    sensitivities : Sensitivities or None
        Derivatives of the arrays by parameters of the model, where they were asked for.
    closure_force : ndarray, shape (closure, 6), or None
        Force and moment that each closure puts on its link b at the closure's place there, base axes
        [N, N m]; None without closures.
    driven : tuple of str
        Joints whose drive was told where to stand; others of loops may have followed.
    """

    arm: Arm
    position: Floats
    displacement: Floats
    rotation: Floats
    joint_torque: Floats
    drive_angle: Floats
    link_angle: Floats
    section_forces: Floats
    base_wrench: Floats
    solver: dict[str, Any]
    parts: dict[str, PartShape] = field(default_factory=dict)
    force: Floats | None = None
    at_link: tuple[str, ...] = ()
    sensitivities: Sensitivities | None = None
    closure_force: Floats | None = None
    driven: tuple[str, ...] = ()

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm static --json`."""
        return to_json_dict(self)

    def contents(self) -> Contents:
        """Return the contents of the file: the equilibrium with units, and its provenance."""
        from flexarm.statics.netcdf import contents

        return contents(self)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> Statics:
        """Read what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is not a stored equilibrium.
        """
        from flexarm.statics.netcdf import stored

        return cls(**stored(path))

    @takes()
    def plot(self, ax: Axes | None = None, scale: float | None = None) -> Axes:
        """Draw the deformed arm over the rigid one, in the plane in which it reaches and moves most.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        scale : float, optional
            Displacements are drawn times it; default: so that they show.
        """
        return drawn(self, ax=ax, scale=scale)

    def view(self, scale: float | None = None, urdf: str | Path | None = None) -> View:
        """Show the deformed arm in three dimensions, with the rigid one.

        Parameters
        ----------
        scale : float, optional
            Displacements are shown times it; default: so that they show.
        urdf : str or Path, optional
            The URDF file whose meshes rigid links are drawn with.

        Returns
        -------
        View
            One page without network; see `Arm.view`.
        """
        return viewed(self, scale=scale, urdf=urdf)

    def summary(self) -> str:
        """Return the result in lines that a person reads."""
        return summary(self)

    def __repr__(self) -> str:
        largest = 1e3 * np.linalg.norm(self.displacement, axis=1).max(initial=0.0)
        return (
            f"<Statics of {self.arm.name!r}: {len(self.points)} points, moved up to {largest:.4g} mm "
            f"from the rigid arm>"
        )


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
            "loops of rigid links. Not unique, and the smallest that fit: "
            f"{found.solver['indeterminate_forces']}"
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
