"""An equilibrium as a NetCDF file: what is stored of it, with units, and how it is read again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arm.joint_units import units_by_joint
from flexarm.arrays import frozen
from flexarm.netcdf import Contents
from flexarm.reading import reading, require
from flexarm.result import AXES, counts, labels, load, model_of, provenance
from flexarm.sensitivity import Sensitivities
from flexarm.statics.part_shape import PartShape

if TYPE_CHECKING:
    from flexarm.statics.statics import Statics

# Axes and attributes of what a stored equilibrium holds; the last two are optional.
_VARIABLES: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "position": (("point", "axis"), {"units": "m"}),
    "displacement": (("point", "axis"), {"units": "m"}),
    "rotation": (("point", "axis", "body_axis"), {"units": "1"}),
    "joint_torque": (("joint",), {"units": "N m"}),
    "drive_angle": (("joint",), {"units": "rad"}),
    "link_angle": (("joint",), {"units": "rad"}),
    "section_forces": (("link", "end", "component"), {"units": "N, N m", "axes": "of the section"}),
    "base_wrench": (("wrench",), {"units": "N, N m"}),
    "force": (("point", "axis"), {"units": "N"}),
    "closure_force": (("closure", "wrench"), {"units": "N, N m"}),
}
_ALWAYS = list(_VARIABLES)[:-2]

# What a file keeps of a PartShape, in its order: variable, axes, unit.
_PART_VARIABLES = (
    ("rotation", ("axis", "body_axis"), "1"),
    ("position", ("axis",), "m"),
    ("freedoms", ("freedom",), "m, rad"),
)


def contents(found: Statics) -> Contents:
    """Return the contents of the file: the equilibrium with units, and its provenance."""
    parts = {
        f"{name}_{what}": ((*(f"{name}_{axis}" for axis in axes),), getattr(shape, what), {"units": units})
        for name, shape in found.parts.items()
        for what, axes, units in _PART_VARIABLES
    }
    whole = Contents(
        {
            **parts,
            **{
                name: (axes, getattr(found, name), attributes | _by_joint(found, axes, attributes["units"]))
                for name, (axes, attributes) in _VARIABLES.items()
                if getattr(found, name) is not None
            },
        },
        {**labels(found), "body_axis": AXES},
        {
            "kind": "statics",
            **provenance(found.arm),
            **found.solver,
            "at_link": " ".join(found.at_link),
            "driven": " ".join(found.driven),
        },
    )
    return whole if found.sensitivities is None else found.sensitivities.add_to(whole)


def _by_joint(found: Statics, axes: tuple[str, ...], unit: str) -> dict[str, str]:
    return {"units": units_by_joint(found.arm, found.joints, unit)} if axes == ("joint",) else {}


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the equilibrium that a file holds.

    Raise InvalidFile if the file is not a stored equilibrium.
    """
    data = load(path, "statics")
    arm = model_of(data, path)
    parts = [link.name for link in arm.links if link.type == "superelement"]
    of_parts = {
        f"{name}_{what}": tuple(f"{name}_freedom" if axis == "freedom" else axis for axis in axes)
        for name in parts
        for what, axes, _ in _PART_VARIABLES
    }
    needed = [*_ALWAYS, *(["closure_force"] if arm.closures else [])]
    require(path, data, {**{name: _VARIABLES[name][0] for name in needed}, **of_parts}, counts(arm))
    told = ["backend", "iterations", "load_steps", "residual_N"]
    told += [k for k in ("redundant_conditions", "indeterminate_forces") if k in data.attrs]
    with reading(path, "a stored equilibrium"):
        return {
            "arm": arm,
            **{name: frozen(data[name].values) for name in _ALWAYS},
            "solver": {k: data.attrs[k] for k in told},
            "parts": {
                name: PartShape(*(frozen(data[f"{name}_{what}"].values) for what, _, _ in _PART_VARIABLES))
                for name in parts
            },
            "force": frozen(data["force"].values) if "force" in data else None,
            "at_link": tuple(str(data.attrs.get("at_link", "")).split()),
            "driven": tuple(str(data.attrs.get("driven", "")).split()),
            "closure_force": frozen(data["closure_force"].values) if arm.closures else None,
            "sensitivities": Sensitivities.stored(arm, data),
        }
