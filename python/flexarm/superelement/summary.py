"""A summary of a super-element, as text and as a dictionary for programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.json_values import plain
from flexarm.superelement.stiffness_checks import rigid_body_error

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


_TOLD = ("backend", "mesh_file", "stiffness_file", "order_of_source", "ignored", "flexarm_version", "created")
"""Facts of the origin."""


def summary(element: SuperElement) -> str:
    """Return the mass, interfaces, modes, quality and origin in lines."""
    return "\n".join(
        [
            f"super-element {element.name}: {element.n_dof} degrees of freedom, {element.n_interfaces} "
            f"interfaces, {element.n_modes} internal modes",
            *_body(element),
            *_interfaces(element),
            *_modes(element),
            *_trust(element),
            *_making(element),
        ]
    )


def to_json_dict(element: SuperElement) -> dict[str, Any]:
    """Return the summary as a dictionary for programs."""
    return {
        "name": element.name,
        "dof": element.n_dof,
        "mass": element.mass_total,
        "centre": element.centre.tolist(),
        "inertia": element.inertia.tolist(),
        "interfaces": [
            {"name": name, "position": position.tolist(), "rotation": rotation.tolist()}
            for name, position, rotation in zip(
                element.interfaces, element.positions, element.rotations, strict=True
            )
        ],
        "frequency_hz": element.frequency_hz.tolist(),
        "rigid_body_error": float(rigid_body_error(element).max()),
        "damped": bool(element.damping.any()),
        "recovery": element.recovery is not None,
        "quality": plain(element.quality),
        "provenance": dict(element.provenance),
    }


def _body(element: SuperElement) -> Iterator[str]:
    x, y, z = _rounded(element.centre)
    J = element.inertia
    six = (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
    size = np.abs(J).max()
    yield f"  mass     {element.mass_total:.6g} kg, centre ({x:.5g}, {y:.5g}, {z:.5g}) m"
    yield (
        "  inertia  "
        + ", ".join(f"{0.0 if abs(i) < 1e-9 * size else i:.5g}" for i in six)
        + (" kg m2 (Ixx, Iyy, Izz, Ixy, Ixz, Iyz) about the centre")
    )


def _interfaces(element: SuperElement) -> Iterator[str]:
    ties = dict(
        entry.split("=", 1) for entry in element.provenance.get("interfaces", "").split("; ") if "=" in entry
    )
    for name, (x, y, z) in zip(element.interfaces, map(_rounded, element.positions), strict=True):
        tied = f", {ties[name]}" if name in ties else ""
        yield f"  interface {name} at ({x:.5g}, {y:.5g}, {z:.5g}) m{tied}"


def _rounded(position: Floats) -> Floats:
    """Set the rounding errors of zeros to zero."""
    return np.where(np.abs(position) < 1e-9 * np.abs(position).max(), 0.0, position)


def _modes(element: SuperElement) -> Iterator[str]:
    shown = 12  # modes that are listed line by line
    if not element.n_modes:
        yield "  no internal modes: static shapes only (Guyan)"
        return
    masses, residuals = _array(element, "effective_mass"), _array(element, "mode_residual")
    told = masses.ndim == 2 and len(masses) == len(residuals) == element.n_modes and element.mass_total > 0
    heading = f"  {'mode':>4} {'frequency [Hz]':>15}"
    if told:
        heading += f"  {'effective mass x, y, z [%]':>28}  {'residual [-]':>12}"
    yield heading + "    (all interfaces held)"
    for i, frequency in enumerate(element.frequency_hz[:shown]):
        line = f"  {i + 1:4d} {frequency:15.6g}"
        if told:
            shares = 100 * masses[i, :3] / element.mass_total
            line += f"  {shares[0]:10.2f}{shares[1]:9.2f}{shares[2]:9.2f}  {residuals[i]:12.1e}"
        yield line
    if element.n_modes > shown:
        yield f"   ... {element.n_modes - shown} more up to {element.frequency_hz[-1]:.6g} Hz"


def _trust(element: SuperElement) -> Iterator[str]:
    quality = element.quality
    trusted = quality.get("trusted_frequency_hz")
    if isinstance(trusted, int | float) and np.isfinite(trusted):
        yield f"  trustworthy up to {trusted:.5g} Hz: {_why_trusted(quality, trusted)}"
    free, errors = _array(element, "free_frequency_hz"), _array(element, "free_frequency_error")
    if len(free) and len(free) == len(errors):
        worst = int(errors.argmax())
        yield (
            f"  free part: {free[0]:.6g} Hz first, {100 * errors[0]:.2g} % too high; worst of the first "
            f"{len(free)} is {free[worst]:.6g} Hz, {100 * errors[worst]:.2g} % too high"
        )
    yield f"  rigid motion strains it by {rigid_body_error(element).max():.1e} of its stiffness"


def _why_trusted(quality: Mapping[str, Any], trusted: float) -> str:
    left_out = quality.get("left_out_frequency_hz")
    if isinstance(left_out, int | float) and trusted < 0.999 * left_out / 1.5:
        return "the first free frequency in error by more than one percent"
    return "the first mode left out is 1.5 times as high"


def _array(element: SuperElement, name: str) -> Floats:
    """Return a quality number as an array, empty if it is not there."""
    value = element.quality.get(name)
    return np.asarray([] if value is None else value, dtype=float)


def _making(element: SuperElement) -> Iterator[str]:
    statistics = element.quality.get("statistics")
    if isinstance(statistics, Mapping):
        phases = ("mesh", "assembly", "check", "factor", "interfaces", "modes", "matrices", "quality")
        times = [(phase, statistics.get(f"seconds_{phase}")) for phase in phases]
        parts = ", ".join(f"{phase} {time:.2f}" for phase, time in times if isinstance(time, int | float))
        yield f"  from {statistics.get('n_freedoms', '?')} degrees of freedom in seconds: {parts}"
    for key in _TOLD:
        if key in element.provenance:
            yield f"  {key.replace('_', ' ')}: {element.provenance[key]}"
