"""A run as a NetCDF file: what is stored of it, with units, and how it is read again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arm.joint_units import units_by_joint
from flexarm.arrays import frozen
from flexarm.netcdf import Contents, Variable
from flexarm.reading import reading, require
from flexarm.result import counts, labels, load, model_of, provenance
from flexarm.sensitivity import Sensitivities
from flexarm.simulation.energies import NAMES as ENERGIES
from flexarm.simulation.energies import Energies

if TYPE_CHECKING:
    from flexarm.simulation.simulation import Simulation

_VARIABLES = {
    "position": (("time", "point", "axis"), "m", "position of points, base axes"),
    "velocity": (("time", "point", "axis"), "m/s", "velocity of points, base axes"),
    "joint_angle": (("time", "joint"), "rad", "angle of the link about its joint"),
    "joint_rate": (("time", "joint"), "rad/s", "its rate"),
    "drive_angle": (("time", "joint"), "rad", "angle of the motor over the ratio"),
    "drive_rate": (("time", "joint"), "rad/s", "its rate"),
    "joint_torque": (("time", "joint"), "N m", "torque on the child about the axis"),
    "motor_torque": (("time", "joint"), "N m", "torque of the motor times the ratio"),
    "kinetic": (("time",), "J", "kinetic energy"),
    "elastic": (("time",), "J", "elastic energy"),
    "gravity": (("time",), "J", "potential energy of gravity"),
    "damped": (("time",), "J", "taken by damping and friction since the start"),
    "work": (("time",), "J", "work of drives and loads since the start"),
    "orientation": (("time", "point", "quaternion"), "1", "orientation of the section at the points"),
    "angular_rate": (("time", "point", "axis"), "rad/s", "angular rate, body axes"),
    "section_forces": (("time", "link", "end", "component"), "N, N m", "section forces, section axes"),
    "base_wrench": (("time", "wrench"), "N, N m", "what the arm puts on the base, base axes"),
    "joint_command": (("time", "joint"), "rad", "angle that the controller is asked for"),
    "motor_voltage": (("time", "joint"), "V", "voltage of the motor"),
}
_ALWAYS = list(_VARIABLES)[:13]
"""Variables of every run; the others are optional."""
_COUNTS = (
    "drive_sha256",
    "backend",
    "step",
    "alpha",
    "dimension",
    "steps",
    "iterations",
    "factorisations",
    "halvings",
    "seconds",
    "redundant_conditions",
    "driven",
)


def contents(run: Simulation) -> Contents:
    """Return the stored content: all arrays with units, and their provenance."""
    variables: dict[str, Variable] = {
        name: (
            dims,
            getattr(run, name),
            {
                "units": units_by_joint(run.arm, run.joints, unit) if "joint" in dims else unit,
                "long_name": text,
            },
        )
        for name, (dims, unit, text) in _VARIABLES.items()
        if getattr(run, name) is not None
    }
    attributes = {"kind": "simulation", **provenance(run.arm), **run.solver}
    time: Variable = (("time",), run.time, {"units": "s"})
    counted = {**labels(run), "quaternion": ["x", "y", "z", "w"]}
    found = Contents(variables, counted, attributes, {"time": time})
    return found if run.sensitivities is None else run.sensitivities.add_to(found)


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the run that a file holds.

    Raise InvalidFile if the file is not a stored run.
    """
    data = load(path, "simulation")
    arm = model_of(data, path)
    there = [name for name in _VARIABLES if name in data or name in _ALWAYS]
    require(path, data, {"time": ("time",), **{name: _VARIABLES[name][0] for name in there}}, counts(arm))
    with reading(path, "a stored run"):
        sensitivities = Sensitivities.stored(arm, data)
    return {
        "arm": arm,
        "time": frozen(data["time"].values),
        **{name: frozen(data[name].values) for name in there if name not in ENERGIES},
        "energy_record": Energies(*(frozen(data[name].values) for name in ENERGIES)),
        "sensitivities": sensitivities,
        "solver": {name: data.attrs[name] for name in _COUNTS if name in data.attrs},
    }
