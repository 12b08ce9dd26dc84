"""A super-element: matrices of a part, reduced to its interfaces and internal modes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm.arguments import ARRAY, NAMES, POSITIVE, SHARE, TABLES, holds, takes
from flexarm.arrays import Floats, frozen
from flexarm.errors import InvalidParameter, Problem
from flexarm.pictures import Shown, viewed
from flexarm.reading import reading
from flexarm.superelement.rigid_motion import PER_INTERFACE, RigidInertia, inertia_load, rigid_inertia
from flexarm.superelement.shape import VARIABLES, problems_of_shape

if TYPE_CHECKING:
    from flexarm.solids import SolidMesh
    from flexarm.viewer import View


@holds(
    interfaces=NAMES,
    positions=ARRAY,
    rotations=ARRAY,
    stiffness=ARRAY,
    mass=ARRAY,
    damping=ARRAY,
    frequency_hz=ARRAY,
    inertia_load=ARRAY,
    quality=TABLES,
    recovery=ARRAY,
    provenance=TABLES,
)
@dataclass(frozen=True, eq=False, repr=False)
class SuperElement(Shown):
    """A reduced part, in SI units and the part's frame.

    The freedoms are, for each interface, three translations and three rotations along and about the part's
    axes at the interface's position, then the internal modes. Arrays are read-only.

    Parameters
    ----------
    name : str
        Name of the part.
    interfaces : tuple of str
        Names of the interfaces, in the order of the freedoms.
    positions : array, shape (n, 3)
        Where the interfaces stand [m].
    rotations : array, shape (n, 3, 3)
        Their axes: column k holds the interface's axis k in the part's axes. They say how joints stand at the
        interface; the matrices keep to the part's axes.
    stiffness, mass, damping : array, shape (dof, dof)
        Reduced matrices K [N/m, N, N m], M [kg, kg m, kg m2], C [N s/m, N s, N m s].
    frequency_hz : array, shape (m,)
        Natural frequencies of the part with all interfaces held [Hz], one an internal mode.
    inertia_load : array, shape (dof, 3), optional
        Generalised force for unit acceleration of the frame along x, y, z: M R_t with R_t its translations.
        Computed if left out.
    quality : mapping, optional
        Numbers that say how good the reduction is, by name.
    recovery : array, shape (3 n_points, dof), optional
        Displacement of every freedom of the mesh for every freedom of the super-element.
    provenance : mapping, optional
        Where the data come from.

    Raises
    ------
    InvalidParameter
        If shapes do not fit, a number is not finite, a matrix is not symmetric, names repeat or axes are not
        orthonormal. What mechanics demands is asked by :meth:`check`.

    Examples
    --------
    >>> part = SuperElement.load("hub.nc")  # doctest: +SKIP
    >>> part.mass_total, part.centre  # doctest: +SKIP
    """

    name: str
    interfaces: tuple[str, ...]
    positions: Floats
    rotations: Floats
    stiffness: Floats
    mass: Floats
    damping: Floats
    frequency_hz: Floats
    inertia_load: Floats = None  # type: ignore[assignment]
    quality: Mapping[str, Any] = field(default_factory=dict)
    recovery: Floats | None = None
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "interfaces", tuple(str(name) for name in self.interfaces))
        for name in (*VARIABLES, "recovery"):
            given = getattr(self, name)
            if given is None and name == "inertia_load":
                given = inertia_load(self.mass, len(self.interfaces))
            if given is not None:
                object.__setattr__(self, name, frozen(given))
        self._refuse(problems_of_shape(self))

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces."""
        return len(self.interfaces)

    @property
    def n_modes(self) -> int:
        """Number of internal modes."""
        return len(self.frequency_hz)

    @property
    def n_dof(self) -> int:
        """Number of freedoms, 6 an interface and 1 an internal mode."""
        return PER_INTERFACE * self.n_interfaces + self.n_modes

    @property
    def mass_total(self) -> float:
        """Mass [kg], from R^T M R with R the rigid motions."""
        return self._inertia.mass

    @property
    def centre(self) -> Floats:
        """Centre of mass in the part's frame [m]."""
        return frozen(self._inertia.centre)

    @property
    def inertia(self) -> Floats:
        """Inertia about the centre of mass, in the part's axes [kg m2]."""
        return frozen(self._inertia.inertia)

    @cached_property
    def _inertia(self) -> RigidInertia:
        return rigid_inertia(self.mass, self.positions)

    @takes()
    def interface(self, name: str) -> tuple[Floats, Floats]:
        """Return the rotation (3, 3) and position (3,) of an interface in the part's frame.

        Raises
        ------
        InvalidParameter
            If there is none of that name.
        """
        if name not in self.interfaces:
            known = ", ".join(self.interfaces)
            what = f"there is no interface {name!r}; there are {known}"
            raise InvalidParameter(what, where=f"super-element {self.name!r}")
        i = self.interfaces.index(name)
        return self.rotations[i], self.positions[i]

    @takes(mass=POSITIVE, tolerance=SHARE)
    def check(self, mass: float | None = None, tolerance: float | None = None) -> list[Problem]:
        """Check what mechanics demands of the matrices, see :mod:`flexarm.superelement.checks`.

        Parameters
        ----------
        mass : float, optional
            What the part weighs, as known from elsewhere [kg].
        tolerance : float, optional
            Relative error that the entries may have; the default suits numbers of six digits.

        Returns
        -------
        list of Problem
            What is allowed and yet looks wrong.

        Raises
        ------
        InvalidParameter
            With everything that no elastic part could have.
        """
        from flexarm.superelement.checks import TOLERANCE, implausible_values, violations

        limit = TOLERANCE if tolerance is None else tolerance
        self._refuse(violations(self, mass, limit))
        return implausible_values(self)

    def _refuse(self, problems: list[Problem]) -> None:
        """Raise an error with all problems, if there are any."""
        if problems:
            first = problems[0]
            raise InvalidParameter(
                first.what, where=f"super-element {self.name!r}: {first.where}", problems=tuple(problems)
            )

    @takes()
    def moved(self, rotation: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> SuperElement:
        """Return the part seen from a frame in which its own stands at (rotation, translation).

        Parameters
        ----------
        rotation : array, shape (3, 3)
            Its column k is the old axis k in the new axes.
        translation : (3,)
            Where the old origin stands in the new frame [m].
        """
        from flexarm.superelement.moved import moved

        return moved(self, rotation, translation)

    def replace(self, **changes: Any) -> SuperElement:
        """Return a copy with some fields changed."""
        return dataclasses.replace(self, **changes)

    def recover(self, coordinates: ArrayLike) -> Floats:
        """Return the displacements of all points of the mesh.

        Parameters
        ----------
        coordinates : array, shape (dof,)
            Displacements of the interfaces [m, rad] and modal coordinates.

        Returns
        -------
        ndarray, shape (n_points, 3)
            Displacements [m] along the part's axes.

        Raises
        ------
        InvalidParameter
            If the super-element was stored without its recovery matrix, or the number of coordinates is
            wrong.
        """
        if self.recovery is None:
            what = "holds no recovery matrix; reduce the part with recovery=True (--recovery)"
            raise InvalidParameter(what, where=f"super-element {self.name!r}")
        q = np.asarray(coordinates, dtype=float)
        if q.shape != (self.n_dof,):
            what = f"coordinates must have the shape ({self.n_dof},), got {q.shape}"
            raise InvalidParameter(what, where=f"super-element {self.name!r}")
        return np.asarray((self.recovery @ q).reshape(-1, 3))

    def von_mises(self, mesh: SolidMesh, coordinates: ArrayLike) -> Floats:
        """Return the von Mises stress at all points of the original mesh [Pa], averaged over their cells.

        Parameters
        ----------
        mesh : SolidMesh
            The part.
        coordinates : array, shape (dof,)
            As for :meth:`recover`, measured from a frame that moves with the part: large rotations are no
            deformation.

        Raises
        ------
        InvalidParameter
            If the part holds no recovery matrix, or not one of this mesh.
        """
        from flexarm import _core

        displacements = self.recover(coordinates)
        if len(displacements) != mesh.n_points:
            what = f"was reduced from {len(displacements)} points, the mesh has {mesh.n_points}"
            raise InvalidParameter(what, where=f"super-element {self.name!r}")
        return np.asarray(_core.von_mises(mesh.core(), displacements))

    def view(self, mesh: SolidMesh | str | Path | None = None) -> View:
        """Show the part in three dimensions: mesh, interfaces and centre of mass.

        Parameters
        ----------
        mesh : SolidMesh, str or Path, optional
            The mesh that it was reduced from; without it sticks join the interfaces.

        Returns
        -------
        View
            One page without network; see `Arm.view`.
        """
        return viewed(self, mesh=mesh)

    def summary(self) -> str:
        """Return the mass, interfaces, modes, quality and origin in lines."""
        from flexarm.superelement.summary import summary

        return summary(self)

    def to_json_dict(self) -> dict[str, Any]:
        """Return the summary as a dictionary for programs."""
        from flexarm.superelement.summary import to_json_dict

        return to_json_dict(self)

    @takes()
    def save(self, path: str | Path, force: bool = False) -> None:
        """Write the super-element as NetCDF; the file appears when it is complete.

        Raises
        ------
        InvalidFile
            If the file exists and `force` is not set, or cannot be written.
        """
        from flexarm.superelement.netcdf import save

        save(self, path, force)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> SuperElement:
        """Read a super-element file, written by flexarm or another program.

        Raises
        ------
        InvalidFile
            If the file is no super-element, or one that no elastic part could have.
        """
        from flexarm.superelement.netcdf import stored

        with reading(path, "a super-element"):
            element = cls(**stored(path))
            element.check()
        return element

    def __repr__(self) -> str:
        return (
            f"<SuperElement {self.name}: interfaces {', '.join(self.interfaces)}; {self.n_modes} modes, "
            f"{self.mass_total:.6g} kg>"
        )
