"""Equilibrium of a loaded arm at rest."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arrays import Floats, frozen
from flexarm.assembly import core_arm
from flexarm.held_arm import HeldArm, positions
from flexarm.netcdf import Contents
from flexarm.result import Result, load, model_of, provenance
from flexarm.sensitivity import Sensitivities

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# What a file keeps of a PartShape, in its order: variable, axes, unit.
_PART_VARIABLES = (
    ("rotation", ("axis", "body_axis"), "1"),
    ("position", ("axis",), "m"),
    ("freedoms", ("freedom",), "m, rad"),
)


@dataclass(frozen=True, eq=False)
class PartShape:
    """Where a super-element is, and how it is deformed.

    Attributes
    ----------
    rotation, position : ndarray, shapes (3, 3) and (3,)
        The part's frame in the base, fixed to its first interface; position in m.
    freedoms : ndarray, shape (dof,)
        Displacements in that frame, in the freedoms of the super-element: of each interface three
        translations [m] and three rotations [rad], then its modes. `SuperElement.recovery` turns them into
        the mesh's.
    """

    rotation: Floats
    position: Floats
    freedoms: Floats


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
    sensitivities : Sensitivities or None
        Derivatives of the arrays by parameters of the model, where they were asked for.
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
    sensitivities: Sensitivities | None = None

    def to_json_dict(self) -> dict[str, Any]:
        """The object of `flexarm static --json`."""
        beams = [(i, link.name) for i, link in enumerate(self.arm.links) if link.type == "beam"]
        ends = ("start", "end")
        return {
            "points": {
                name: {"position": self.position[i].tolist(), "displacement": self.displacement[i].tolist()}
                for i, name in enumerate(self.points)
            },
            "joints": {
                name: {
                    "torque": float(self.joint_torque[i]),
                    "drive_angle": float(self.drive_angle[i]),
                    "link_angle": float(self.link_angle[i]),
                }
                for i, name in enumerate(self.joints)
            },
            "links": {
                name: {end: _wrench(self.section_forces[i, k]) for k, end in enumerate(ends)}
                for i, name in beams
            },
            "base": _wrench(self.base_wrench),
            "solver": self.solver,
        }

    def contents(self) -> Contents:
        """What is stored: the equilibrium with units, and where it comes from."""
        axis = ["x", "y", "z"]
        component = ["N", "Vy", "Vz", "T", "My", "Mz"]
        parts = {
            f"{name}_{what}": (
                (*(f"{name}_{axis}" for axis in axes),),
                getattr(shape, what),
                {"units": units},
            )
            for name, shape in self.parts.items()
            for what, axes, units in _PART_VARIABLES
        }
        contents = Contents(
            {
                **parts,
                "position": (("point", "axis"), self.position, {"units": "m"}),
                "displacement": (("point", "axis"), self.displacement, {"units": "m"}),
                "rotation": (("point", "axis", "body_axis"), self.rotation, {"units": "1"}),
                "joint_torque": (("joint",), self.joint_torque, {"units": "N m"}),
                "drive_angle": (("joint",), self.drive_angle, {"units": "rad"}),
                "link_angle": (("joint",), self.link_angle, {"units": "rad"}),
                "section_forces": (
                    ("link", "end", "component"),
                    self.section_forces,
                    {"units": "N, N m", "axes": "of the section"},
                ),
                "base_wrench": (("wrench",), self.base_wrench, {"units": "N, N m"}),
            },
            {
                "point": self.points,
                "joint": self.joints,
                "link": [link.name for link in self.arm.links],
                "axis": axis,
                "body_axis": axis,
                "end": ["start", "end"],
                "component": component,
                "wrench": ["Fx", "Fy", "Fz", "Mx", "My", "Mz"],
            },
            {"kind": "statics", **provenance(self.arm), **self.solver},
        )
        return contents if self.sensitivities is None else self.sensitivities.add_to(contents)

    @classmethod
    def load(cls, path: str | Path) -> Statics:
        """Reads what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is not a stored equilibrium.
        """
        data = load(path, "statics")
        names = (
            "position",
            "displacement",
            "rotation",
            "joint_torque",
            "drive_angle",
            "link_angle",
            "section_forces",
            "base_wrench",
        )
        arrays: dict[str, Any] = {name: frozen(data[name].values) for name in names}
        solver = {k: data.attrs[k] for k in ("backend", "iterations", "load_steps", "residual_N")}
        arm = model_of(data)
        parts = {
            link.name: PartShape(
                *(frozen(data[f"{link.name}_{what}"].values) for what, _, _ in _PART_VARIABLES)
            )
            for link in arm.links
            if link.type == "superelement"
        }
        return cls(
            arm=arm, solver=solver, parts=parts, sensitivities=Sensitivities.stored(arm, data), **arrays
        )

    def plot(self, ax: Axes | None = None, scale: float = 1.0) -> Axes:
        """Rigid and deformed places of the points in the x-z plane, displacements times `scale`."""
        import matplotlib.pyplot as plt

        axes = plt.subplots()[1] if ax is None else ax
        rigid = self.position - self.displacement
        shown = rigid + scale * self.displacement
        axes.plot(rigid[:, 0], rigid[:, 2], "o", mfc="none", color="0.5", label="rigid arm")
        axes.plot(shown[:, 0], shown[:, 2], "o", color="C0", label=f"equilibrium, displacement x{scale:g}")
        for i, name in enumerate(self.points):
            axes.annotate(name, (shown[i, 0], shown[i, 2]), xytext=(6, 4), textcoords="offset points")
        axes.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
        axes.legend()
        return axes

    def summary(self) -> str:
        """The result in lines that a person reads."""
        lines = [f"equilibrium of {self.arm.name} under gravity {list(self.arm.gravity)} m/s2"]
        lines.append(f"{'point':<16}{'x [m]':>12}{'y [m]':>12}{'z [m]':>12}{'moved [mm]':>34}")
        for i, name in enumerate(self.points):
            where = "".join(f"{value:12.6f}" for value in self.position[i])
            moved = ", ".join(f"{1e3 * value:.4f}" for value in self.displacement[i])
            lines.append(f"{name:<16}{where}{moved:>34}")
        slides = any(joint.type == "prismatic" for joint in self.arm.joints)
        angle, torque = ("[rad, m]", "[N m, N]") if slides else ("[rad]", "[N m]")
        lines.append(f"{'joint':<16}{f'drive {angle}':>16}{f'link {angle}':>16}{f'torque {torque}':>18}")
        for i, name in enumerate(self.joints):
            lines.append(
                f"{name:<16}{self.drive_angle[i]:16.8f}{self.link_angle[i]:16.8f}{self.joint_torque[i]:18.5f}"
            )
        lines.append(f"{'beam':<16}{'N, Vy, Vz [N]':>36}{'T, My, Mz [N m]':>36}")
        for i, link in enumerate(self.arm.links):
            for k, end in enumerate(("start", "end") if link.type == "beam" else ()):
                force, moment = _text(self.section_forces[i, k, :3]), _text(self.section_forces[i, k, 3:])
                lines.append(f"{link.name + ' ' + end:<16}{force:>36}{moment:>36}")
        force, moment = _text(self.base_wrench[:3]), _text(self.base_wrench[3:])
        lines.append(f"{'on the base':<16}{force:>36}{moment:>36}   about its origin, base axes")
        return "\n".join(lines)

    def __repr__(self) -> str:
        largest = 1e3 * np.linalg.norm(self.displacement, axis=1).max(initial=0.0)
        return (
            f"<Statics of {self.arm.name!r}: {len(self.points)} points, moved up to {largest:.4g} mm "
            f"from the rigid arm>"
        )


def static(
    arm: Arm,
    joints: Mapping[str, float] | None = None,
    forces: Mapping[str, ArrayLike] | None = None,
    *,
    at_link: Collection[str] = (),
    sensitivities: Iterable[str] = (),
) -> Statics:
    """Equilibrium under gravity and point forces, the joints' drives held.

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    joints : dict of str to float, optional
        Drive angles, output side [rad, m for a prismatic joint]; default 0.
    forces : dict of str to (3,), optional
        Forces at points, base axes [N].
    at_link : collection of str
        Joints whose angle in `joints` is the link's, as an encoder behind the reducer gives it. What their
        motor's own angle must then be is not computed: `drive_angle` is the link's.
    sensitivities : iterable of str
        Keys of parameters by which the arrays are differentiated, as in `simulate`.

    Raises
    ------
    InvalidParameter
        If a joint or point does not exist.
    NotConverged
        If there is no stable equilibrium; the message says at what part of the load the arm buckles.

    Examples
    --------
    >>> flexarm.static(arm, joints={"hinge": 0.5}).displacement  # doctest: +SKIP
    """
    held = HeldArm(arm, at_link, forces or (), sensitivities)
    found = held.at(joints or {}, forces)
    return Statics(
        arm=arm,
        displacement=frozen(found.arrays["position"] - _rigid(arm, held.system, found.values)),
        drive_angle=frozen(found.values),
        **{name: frozen(array) for name, array in found.arrays.items()},
        solver={
            "backend": _core.build_info().solver,
            "iterations": found.equilibrium.iterations,
            "load_steps": found.equilibrium.load_steps,
            "residual_N": found.equilibrium.residual,
        },
        parts=_parts(arm, held.system, found.equilibrium.state),
        sensitivities=found.sensitivities,
    )


def _rigid(arm: Arm, system: _core.System, values: list[float]) -> Floats:
    """The points of the rigid arm without effects: what effects move counts as displacement."""
    if not arm.effects:
        return positions(system, system.rigid_state(values), len(arm.points))
    kinds = {gear.output: _core.DriveKind.free for gear in arm.gears}
    plain = _core.System(core_arm(arm, nominal=True), kinds)
    return positions(plain, plain.rigid_state(values), len(arm.points))


def _parts(arm: Arm, system: _core.System, state: _core.State) -> dict[str, PartShape]:
    names = [link.name for link in arm.links if link.type == "superelement"]
    shapes = (system.part_shape(state, i) for i in range(len(names)))
    return {
        name: PartShape(frozen(frame.R), frozen(frame.x), frozen(freedoms))
        for name, (frame, freedoms) in zip(names, shapes, strict=True)
    }


def _wrench(values: Floats) -> dict[str, list[float]]:
    return {"force": values[:3].tolist(), "moment": values[3:].tolist()}


def _text(values: Floats) -> str:
    return ", ".join(f"{value:.4f}" for value in values)
