"""A solid mesh, reduced to its interfaces and internal modes (Craig-Bampton; Guyan without modes)."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from flexarm import _core as _typed_core
from flexarm.arguments import FLAG, NAMED, POSITIVE, takes
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.reduction.interface_set import InterfaceSet, refuse_shared
from flexarm.solids import SolidMesh, read_mesh
from flexarm.solids.checks import refuse_implausible
from flexarm.superelement import SuperElement

_core: Any = _typed_core


Progress = Callable[[str, float], None]
"""Hears the phase that runs and the part of it that is done, 0 to 1."""


@takes(interfaces=NAMED, mass=POSITIVE, recovery=FLAG)
def reduce_mesh(
    mesh: SolidMesh | str | Path,
    interfaces: Mapping[str, InterfaceSet | str],
    *,
    modes: int | None = None,
    max_frequency: float | None = None,
    unit: str = "m",
    damping_ratio: float = 0.0,
    lumped: bool = False,
    mass: float | None = None,
    recovery: bool = False,
    name: str | None = None,
    threads: int = 0,
    progress: Progress | None = None,
) -> SuperElement:
    """Reduce a part to a super-element.

    Parameters
    ----------
    mesh : SolidMesh, str or Path
        The part, or a mesh file.
    interfaces : mapping
        Name -> a point set of the mesh, "SET", "SET:average", or an `InterfaceSet`. In the order given they
        become the interfaces of the super-element.
    modes : int, optional
        Internal modes to keep, lowest first; 20 if neither this nor `max_frequency` is given. 0 is Guyan's
        reduction.
    max_frequency : float, optional
        Instead: keep all internal modes up to this frequency [Hz].
    unit : str
        Unit of length of a mesh file.
    damping_ratio : float
        Of the free part in its first elastic mode; stiffness-proportional.
    lumped : bool
        Lumped instead of consistent masses.
    mass : float, optional
        What the part weighs [kg]; the reduced part must agree within 0.1 %. Needed for a part of a size or
        mass that no part of an arm has (`flexarm.solids.checks`).
    recovery : bool
        Keep the matrix that gives the displacements of all points, 24 bytes a point and freedom.
    name : str, optional
        Name of the part; that of the mesh file if left out.
    threads : int
        For the assembly; 0 takes all.
    progress : callable, optional
        Called with the phase and the part of it that is done; may raise to end the work.

    Returns
    -------
    SuperElement
        With `quality`: how far the reduction can be trusted, and how the numbers came about.

    Raises
    ------
    InvalidParameter
        If the mesh or an interface is at fault; `InvalidFile` if it comes from a file.
    NotConverged
        If the internal modes are not found.

    Examples
    --------
    >>> part = flexarm.reduce_mesh("hub.inp", {"input": "BORE", "output": "FLANGE:average"}, unit="mm")
    ... # doctest: +SKIP
    """
    started = perf_counter()
    tell = progress or (lambda phase, done: None)
    tell("mesh", 0.0)
    solid, source = _checked(mesh, unit)
    if mass is None:
        refuse_implausible(solid)
    sets = {key: _interface_set(value) for key, value in interfaces.items()}
    if not sets:
        raise InvalidParameter("there must be at least one interface, got none", where="interfaces")
    count, limit = _wanted(modes, max_frequency)
    refuse_shared(sets, solid)
    held = [item.core(key, solid) for key, item in sets.items()]
    tell("assembly", 0.0)
    meshed = perf_counter()
    K, M = _core.assemble_solids(solid.core(), lumped, threads)
    assembled = perf_counter()
    found = _core.reduce_part(K, M, solid.points, held, count, limit, progress)
    ties = [f"{name}={item.kind}, {item.size(solid)} points" for name, item in sets.items()]
    element = SuperElement(
        name=name or (Path(solid.file).stem if solid.file else "part"),
        interfaces=tuple(sets),
        positions=np.array([item.at(solid) for item in sets.values()]),
        rotations=np.array([np.eye(3) if i.rotation is None else i.rotation for i in sets.values()]),
        stiffness=found.stiffness,
        mass=found.mass,
        damping=stiffness_proportional(found.stiffness, found.mass, damping_ratio),
        frequency_hz=found.frequency_hz,
        inertia_load=found.inertia_load,
        recovery=found.recovery if recovery else None,
        quality=_quality(found, {"mesh": meshed - started, "assembly": assembled - meshed}),
        provenance={
            **source,
            "interfaces": "; ".join(ties),
            "modes_wanted": f"up to {limit:g} Hz" if limit else str(count),
            "masses": "lumped" if lumped else "consistent",
            "damping_ratio": f"{damping_ratio:g}",
            "backend": f"{found.statistics.factor.backend}, {found.statistics.factor.ordering}",
        },
    )
    element.check(mass=mass)
    return element


def _checked(mesh: SolidMesh | str | Path, unit: str) -> tuple[SolidMesh, dict[str, str]]:
    """Return the mesh, checked, and its provenance."""
    if isinstance(mesh, str | Path):
        solid = read_mesh(mesh, unit=unit).check()
        digest = hashlib.sha256(Path(mesh).read_bytes()).hexdigest()
        return solid, {"mesh_file": Path(mesh).name, "mesh_unit": unit, "mesh_sha256": digest}
    mesh.check()
    hashed = hashlib.sha256(mesh.points.tobytes())
    for kind, nodes in mesh.cells.items():
        hashed.update(kind.encode() + nodes.tobytes())
    source = {"mesh_file": Path(mesh.file).name} if mesh.file else {}
    return mesh, {**source, "mesh_sha256": hashed.hexdigest()}


def _interface_set(value: InterfaceSet | str) -> InterfaceSet:
    if isinstance(value, InterfaceSet):
        return value
    return InterfaceSet.from_text(value) if isinstance(value, str) else InterfaceSet(value)


def _wanted(modes: int | None, max_frequency: float | None) -> tuple[int, float]:
    """Return the number of modes and the frequency limit, one of them zero."""
    most_modes = 1000
    default_modes = 20
    if modes is not None and max_frequency is not None:
        raise InvalidParameter("give modes or max_frequency, not both", where="modes")
    if modes is not None and not (isinstance(modes, int | np.integer) and 0 <= modes <= most_modes):
        raise InvalidParameter(f"must be a whole number, 0 to {most_modes}, got {modes}", where="modes")
    if max_frequency is None:
        return (default_modes if modes is None else modes), 0.0
    if not 0 < max_frequency < math.inf:
        raise InvalidParameter(f"must be positive, got {max_frequency:g} Hz", where="max_frequency")
    return 0, max_frequency


def _quality(found: Any, seconds: dict[str, float]) -> dict[str, Any]:
    """Return numbers that say how good the reduction is and how it was made."""
    quality, statistics = found.quality, found.statistics
    told = {name: getattr(quality, name) for name in dir(quality) if not name.startswith("_")}
    run = {name: getattr(statistics, name) for name in dir(statistics) if not name.startswith("_")}
    factor = run.pop("factor")
    run["factor"] = {name: getattr(factor, name) for name in dir(factor) if not name.startswith("_")}
    run["seconds_mesh"], run["seconds_assembly"] = seconds["mesh"], seconds["assembly"]
    return {**told, "statistics": run}


def stiffness_proportional(stiffness: Floats, mass: Floats, damping_ratio: float) -> Floats:
    """Return the damping of a reduced part, which never damps rigid motion.

        C = beta K,    beta = 2 zeta/omega_1                                                             (1)

    gives the first elastic mode of the free part, of frequency omega_1, the damping ratio zeta, and a mode of
    frequency omega the ratio zeta omega/omega_1.

    Raise InvalidParameter if the ratio is not in [0, 1), or the part is rigid.
    """
    if not 0 <= damping_ratio < 1:
        raise InvalidParameter(f"must be in [0, 1), got {damping_ratio:g}", where="damping_ratio")
    if damping_ratio == 0:
        return np.zeros_like(stiffness)
    elastic = free_frequencies(stiffness, mass)
    if not len(elastic):
        what = "needs an elastic mode: the part has one interface and no internal modes, so it is rigid"
        raise InvalidParameter(what, where="damping_ratio")
    return np.asarray(2 * damping_ratio / (2 * np.pi * elastic[0]) * stiffness)  # eq. (1)


def free_frequencies(stiffness: Floats, mass: Floats) -> Floats:
    """Return the frequencies of the free part [Hz] without its six rigid motions."""
    from scipy.linalg import eigh

    squares = eigh(stiffness, mass, eigvals_only=True)[6:]
    return np.asarray(np.sqrt(np.maximum(squares, 0)) / (2 * np.pi))
