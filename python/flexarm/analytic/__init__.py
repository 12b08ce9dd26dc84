"""The simple models beside the finite elements: exact modes, equations (1) and (2), the rigid arm.

They describe one flexible link on one revolute joint in a vertical plane and serve as references
and as fast surrogates. Derivations: docs/theory.md.

    link = FlexibleLink(length=3.0, bending_stiffness=49770.0, mass_per_length=4.57, tip_mass=14.1)
    arm = NonlinearModal(pinned_free_basis(link, 4), damping_ratio=0.005)
    motion = simulate(arm, MotorAngle(CubicSpline(time, encoder), stiffness=1e5), time)

or, with the data of a model, `OneLinkArm.of(Arm.from_toml("arm.toml"))`.
"""

from flexarm.analytic.drives import CoulombFriction, JointTorque, MotorAngle
from flexarm.analytic.exact_modes import ExactModes, exact_modes
from flexarm.analytic.flexible_link import FlexibleLink
from flexarm.analytic.integration import simulate
from flexarm.analytic.linear_modal import LinearModal
from flexarm.analytic.modal_basis import ModalBasis, pinned_free_basis
from flexarm.analytic.motion import ArmMotion, rigid_tip, tip_position
from flexarm.analytic.nonlinear_modal import NonlinearModal
from flexarm.analytic.one_link_arm import OneLinkArm
from flexarm.analytic.ramped_sine import RampedSine
from flexarm.analytic.statics import equilibrium, small_vibrations_hz

__all__ = [
    "ArmMotion",
    "CoulombFriction",
    "ExactModes",
    "FlexibleLink",
    "JointTorque",
    "LinearModal",
    "ModalBasis",
    "MotorAngle",
    "NonlinearModal",
    "OneLinkArm",
    "RampedSine",
    "equilibrium",
    "exact_modes",
    "pinned_free_basis",
    "rigid_tip",
    "simulate",
    "small_vibrations_hz",
    "tip_position",
]
