"""Results of an equilibrium: positions of points, torques, section forces, shapes of parts."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import PATH, takes
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
        from flexarm.statics.summary import to_json_dict

        return to_json_dict(self)

    def contents(self) -> Contents:
        """Return the contents of the file: the equilibrium with units, and its provenance."""
        from flexarm.statics.netcdf import contents

        return contents(self)

    @classmethod
    @takes(path=PATH)
    def load(cls, path: str | Path) -> Statics:
        """Read what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is not a stored equilibrium.
        """
        from flexarm.statics.netcdf import stored

        return cls(**stored(path))

    def plot(self, ax: Axes | None = None, scale: float | None = None) -> Axes:
        """Draw the deformed arm over the rigid one, in the plane in which it reaches farthest.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        scale : float, optional
            Displacements are drawn times it; default: so that they show.
        """
        found: Axes = drawn(self, ax=ax, scale=scale)
        return found

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
        found: View = viewed(self, scale=scale, urdf=urdf)
        return found

    def summary(self) -> str:
        """Return the result in lines that a person reads."""
        from flexarm.statics.summary import summary

        return summary(self)

    def __repr__(self) -> str:
        largest = 1e3 * np.linalg.norm(self.displacement, axis=1).max(initial=0.0)
        return (
            f"<Statics of {self.arm.name!r}: {len(self.points)} points, moved up to {largest:.4g} mm "
            f"from the rigid arm>"
        )
