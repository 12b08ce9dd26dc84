"""Equations (1) and (2) of a model: the data of an `Arm` with one revolute joint and one beam.

The arm must move in a vertical plane, stand upright or hang at q = 0, bend alike in its two planes and
carry its payloads at the far end. A beam's damping η = 2 ζ/ω_1 (ω_1: first clamped mode without
payload) gives each mode the ratio η ω_i/2. Shear and rotary inertia of the section, and effects other
than joint compliance, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from flexarm.analytic.drives import MotorAngle, TimeFunction
from flexarm.analytic.exact_modes import exact_modes
from flexarm.analytic.flexible_link import FlexibleLink
from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.modal_basis import pinned_free_basis
from flexarm.analytic.nonlinear_modal import NonlinearModal
from flexarm.arm.inertia import inertia_matrix
from flexarm.arm.rotation import from_rpy
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.arm.joint import Joint
    from flexarm.arm.link import Beam


@dataclass(frozen=True)
class OneLinkArm:
    """The data of an arm that the modal equations use."""

    link: FlexibleLink
    """Beam and load."""
    stiffness: float
    joint_damping: float
    """Between motor and hub [N m/rad], [N m s/rad]; inf and 0 without joint compliance."""
    beam_damping: float
    """η [s], damping over stiffness of the beam."""
    gravity: float
    """g [m/s²]."""
    hanging: bool
    """The arm hangs at q = 0."""

    @classmethod
    def of(cls, arm: Arm) -> OneLinkArm:
        """Take the data of a model.

        Raise InvalidParameter if the arm is not one beam on one revolute joint as described above; says what
        is in the way.
        """
        joint, beam = _one_joint_one_beam(arm)
        link = _flexible_link(arm, beam)
        bare = FlexibleLink(link.length, link.bending_stiffness, link.mass_per_length)
        compliance = arm.effect("joint_compliance", joint.name)
        return cls(
            link=link,
            stiffness=getattr(compliance, "stiffness", inf),
            joint_damping=getattr(compliance, "damping", 0.0),
            beam_damping=2 * beam.damping_ratio / float(exact_modes(bare, 1).omega[0]),
            gravity=-arm.gravity[2],
            hanging=_hangs(arm, joint, beam),
        )

    def nonlinear(self, n_bending: int = 4) -> NonlinearModal:
        """Return equation (1) with n bending shapes."""
        basis = pinned_free_basis(self.link, n_bending)
        return NonlinearModal(
            basis, tuple(self.beam_damping * basis.omega[1:] / 2), self.gravity, self.hanging
        )

    def linear(self, n_bending: int = 4) -> LinearModal:
        """Return equation (2) with n bending shapes."""
        basis = pinned_free_basis(self.link, n_bending)
        return LinearModal(basis, tuple(self.beam_damping * basis.omega[1:] / 2), self.gravity, self.hanging)

    def drive(self, angle: TimeFunction) -> MotorAngle:
        """Drive the joint by a motor angle φ(t, nu), output-referred [rad]."""
        return MotorAngle(angle, self.stiffness, self.joint_damping)


def _one_joint_one_beam(arm: Arm) -> tuple[Joint, Beam]:
    if len(arm.joints) != 1 or len(arm.links) != 1:
        raise InvalidParameter(
            "the modal equations hold for one joint and one link, "
            f"{arm.name!r} has {len(arm.joints)} and {len(arm.links)}"
        )
    joint, beam = arm.joints[0], arm.links[0]
    if joint.type != "revolute" or beam.type != "beam":
        raise InvalidParameter(
            "the modal equations hold for a beam on a revolute joint, "
            f"{arm.name!r} has a {beam.type} link on a {joint.type} joint"
        )
    return joint, beam


def _flexible_link(arm: Arm, beam: Beam) -> FlexibleLink:
    for load in arm.payloads:
        if np.abs(np.subtract(load.position, beam.end)).max() > 1e-9 * beam.length:
            raise InvalidParameter(
                f"payload {load.name!r}: the modal equations need it at the far end {list(beam.end)} m, "
                f"got {list(load.position)} m"
            )
    first, second = beam.section.second_moments
    if abs(first - second) > 1e-9 * first:
        what = f"link {beam.name!r}: the modal equations need Iy = Iz, got {first:.4g} and {second:.4g} m4"
        raise InvalidParameter(what)
    axis = np.array(arm.joints[0].axis) / np.linalg.norm(arm.joints[0].axis)
    return FlexibleLink(
        length=beam.length,
        bending_stiffness=beam.material.youngs_modulus * first,
        mass_per_length=beam.material.density * beam.section.area,
        tip_mass=sum(load.mass for load in arm.payloads),
        tip_inertia=sum(float(axis @ np.array(inertia_matrix(load.inertia)) @ axis) for load in arm.payloads),
    )


def _hangs(arm: Arm, joint: Joint, beam: Beam) -> bool:
    frame = np.array(from_rpy(joint.origin.rpy))
    axis = frame @ np.array(joint.axis) / np.linalg.norm(joint.axis)
    along = frame @ np.array(beam.end) / beam.length
    if abs(axis[1] - 1) > 1e-9 or abs(abs(along[2]) - 1) > 1e-9 or any(arm.gravity[:2]):
        raise InvalidParameter(
            f"joint {joint.name!r}: the modal equations need its axis along y, the arm along z at q = 0 "
            f"and gravity along z, got axis {axis.round(6).tolist()}, arm {along.round(6).tolist()}"
        )
    return bool(along[2] < 0)
