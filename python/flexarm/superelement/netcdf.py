"""Super-element files: NetCDF with the attribute `format = "flexarm-superelement/1"`.

Variables and dimensions are listed in docs/superelements.md. Any NetCDF that holds them is read, whoever
wrote it: classic or HDF5, single or double precision, names as strings or characters, dimensions by any name.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.configuration import config
from flexarm.errors import InvalidFile, Problem
from flexarm.netcdf import Contents
from flexarm.netcdf import save as write
from flexarm.output import refuse_existing
from flexarm.superelement.rigid_motion import inertia_load
from flexarm.superelement.variables import Variables, read_variables, texts

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement

FORMAT = "flexarm-superelement/1"

DIMENSIONS = {
    "interface_position": ("interface", "axis"),
    "interface_rotation": ("interface", "axis", "interface_axis"),
    "stiffness": ("dof", "dof"),
    "mass": ("dof", "dof"),
    "damping": ("dof", "dof"),
    "frequency_hz": ("mode",),
    "inertia_load": ("dof", "axis"),
}

UNITS = {
    "interface_position": "m",
    "interface_rotation": "1",
    "stiffness": "N/m, N, N m",
    "mass": "kg, kg m, kg m2",
    "damping": "N s/m, N s, N m s",
    "frequency_hz": "Hz",
    "inertia_load": "kg, kg m",
}


def save(element: SuperElement, path: str | Path, force: bool = False, inputs: Iterable[Path] = ()) -> None:
    """Write a super-element; the file appears when it is complete, and replaces no input.

    Raises
    ------
    InvalidFile
        If the file exists and `force` is not set, or cannot be written.
    """
    refuse_existing(Path(path), force, inputs)
    write(contents(element), path)


def contents(element: SuperElement) -> Contents:
    """Return the content of a super-element's file."""
    values: dict[str, Any] = {
        "interface_position": element.positions,
        "interface_rotation": element.rotations,
        "stiffness": element.stiffness,
        "mass": element.mass,
        "damping": element.damping,
        "frequency_hz": element.frequency_hz,
        "inertia_load": element.inertia_load,
    }
    variables: dict[str, Any] = {"interface_name": (("interface",), list(element.interfaces), {})}
    for name, array in values.items():
        variables[name] = (DIMENSIONS[name], array, {"units": UNITS[name]})
    if element.recovery is not None:
        variables["recovery"] = (("point_dof", "dof"), element.recovery, {"units": "1, m, 1/sqrt(kg)"})
    attributes = {
        "format": FORMAT,
        "name": element.name,
        "units": "SI: m, kg, s, N, Pa, rad; the part's frame",
        "quality": json.dumps(_plain(element.quality)),
        **_provenance(),
        **element.provenance,
    }
    return Contents(variables, attributes=attributes)


def _provenance() -> dict[str, str]:
    versions = config()
    return {
        "flexarm_version": versions["flexarm"],
        "git": versions["git"],
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _plain(value: Any) -> Any:
    """Convert arrays to lists and infinity to null, so that JSON takes them."""
    if isinstance(value, dict) or hasattr(value, "items"):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def stored(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the super-element in a file.

    Raises
    ------
    InvalidFile
        If the file is no super-element.
    """
    data = read_variables(path)
    if data.attributes.get("format") != FORMAT:
        found = data.attributes.get("format", "none")
        raise InvalidFile(path, "format", f"the attribute must be {FORMAT!r}, got {found!r}")
    return _attributes(data, path)


def _attributes(data: Variables, path: str | Path) -> dict[str, Any]:
    """Return the attributes; a variable that is missing or holds no numbers is reported with its name."""
    n = (*_shape(data, "interface_name"), 0)[0]
    left_out = ["inertia_load"] + ["frequency_hz"] * (_shape(data, "stiffness") == (6 * n, 6 * n))
    needed = [name for name in ("interface_name", *DIMENSIONS) if name not in left_out]
    missing = [name for name in needed if name not in data.arrays]
    if missing:
        what = f"is missing; a super-element file holds interface_name, {', '.join(DIMENSIONS)}"
        raise InvalidFile(path, missing[0], what, problems=tuple(Problem(name, what) for name in missing))
    mass = _numbers(data, "mass", path)
    there = [name for name in ("frequency_hz", "inertia_load", "recovery") if name in data.arrays]
    optional = {name: _numbers(data, name, path) for name in there}
    return dict(
        name=str(data.attributes.get("name") or Path(path).stem),
        interfaces=_interface_names(data, path),
        positions=_numbers(data, "interface_position", path),
        rotations=_numbers(data, "interface_rotation", path),
        stiffness=_numbers(data, "stiffness", path),
        mass=mass,
        damping=_numbers(data, "damping", path),
        frequency_hz=optional["frequency_hz"] if "frequency_hz" in optional else np.zeros(0),
        inertia_load=optional["inertia_load"] if "inertia_load" in optional else inertia_load(mass, n),
        recovery=optional.get("recovery"),
        quality=_quality(data),
        provenance={str(k): str(v) for k, v in data.attributes.items() if k not in _OWN_ATTRIBUTES},
    )


_OWN_ATTRIBUTES = ("format", "name", "units", "quality")


def _shape(data: Variables, name: str) -> tuple[int, ...]:
    return tuple(data.arrays[name].shape) if name in data.arrays else ()


def _numbers(data: Variables, name: str, path: str | Path) -> Floats:
    values = data.arrays[name]
    if values.dtype.kind not in "fiu":
        raise InvalidFile(path, name, f"must hold real numbers, got values of type {values.dtype}")
    return np.asarray(values, dtype=float)


def _interface_names(data: Variables, path: str | Path) -> tuple[str, ...]:
    values = data.arrays["interface_name"]
    names = texts(values)
    if names is None:
        what = f"must be a list of names, got shape {values.shape} of type {values.dtype}"
        raise InvalidFile(path, "interface_name", what)
    return tuple(names)


def _quality(data: Variables) -> dict[str, Any]:
    """Return what `save` stored; another program's attribute of that name is ignored."""
    try:
        told = json.loads(data.attributes.get("quality", "{}"))
    except (TypeError, ValueError, RecursionError):
        return {}
    return told if isinstance(told, dict) else {}
