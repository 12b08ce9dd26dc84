"""Traits of effects: what a search for missing effects must know of each, stated in the effect's own file.

Defaults suit a law that is smooth, linear in its parameters, zero where they are zero, and seen in poses and
in motion. A subclass of `flexarm.arm.Effect` overrides what differs. `flexarm.diagnosis` names no effect.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from flexarm.tables import Table


class EffectTraits(Table):
    """Class attributes of an effect that a search reads."""

    # ------------------------------------------------------------------ where it competes

    competes: ClassVar[bool] = True
    """False if the search leaves it out: the checks before the search find faults of sensors."""
    requires: ClassVar[str | None] = None
    """Name of the effect at the same place without which it cannot act, such as the spring of a backlash."""
    torque_at: ClassVar[Literal["motor", "output"] | None] = None
    """Side of a joint's spring where the law is a torque.

    At the output of a rigid joint the drive takes it, and no place moves. At the motor it moves the arm where
    the joint follows commands; else only a motor's torque shows it.
    """
    pins_of_loops_only: ClassVar[bool] = False
    """True if it is sought only at joints and closures that turn in closed loops, whose pins carry much."""
    stated_only: ClassVar[bool] = False
    """True if it is sought only where a model states it, as what only its maker's drawing tells."""
    at_closures: ClassVar[tuple[str, ...]] = ()
    """Types of closures at which it acts, too: about the axis, along it, or in the bearing."""
    sought_of_commands: ClassVar[tuple[str, ...]] = ()
    """Parameters that a search fits only at joints that follow commands; elsewhere another effect stands for
    them."""
    driven_joints_only: ClassVar[bool] = False
    """True if it is a constant angle, and no error, at a joint that no drive turns."""
    stated_by_records: ClassVar[bool] = False
    """True if a record may state its value, such as the mass of a payload; if all do it does not compete."""
    in_motion: ClassVar[tuple[str, ...]] = ()
    """Parameters that poses do not show; an effect without others does not compete if all are poses."""

    # ------------------------------------------------------------------ its law

    smooth: ClassVar[bool] = True
    """False if the law has a corner, such as the sign of a rate: finite steps then replace derivatives."""
    is_spring: ClassVar[bool] = False
    """True for a `SpringEffect`: the prediction is linear in 1/stiffness."""
    is_wave: ClassVar[bool] = False
    """True for a `WaveEffect`: a sine with an amplitude and a phase."""
    acts_as: ClassVar[str | None] = None
    """Name of the spring whose part it plays in small motions, such as a hysteresis that sticks."""

    # ------------------------------------------------------------------ its parameters

    one_signed: ClassVar[bool] = False
    """True if least squares must not take away the effect from a model that has none of it."""
    non_negative: ClassVar[tuple[str, ...]] = ()
    """Parameters that cannot be negative: a fit starts at a small part of a probe, at least."""
    shape: ClassVar[tuple[str, ...]] = ()
    """Parameters that say how it acts and not how much: a fit starts from them as they are probed."""
    multistart: ClassVar[str | None] = None
    """Parameter in which the misfit has several minima: fits start from a range of its values."""
    may_vanish: ClassVar[bool] = False
    """True if a machine may well have next to none of it, so that the lower end of its size is no warning."""

    # ------------------------------------------------------------------ where it shows

    leaves_plane: ClassVar[bool] = False
    """True if it moves nothing, to first order, in an arm that moves in a plane and is symmetric to it."""
    always_turns: ClassVar[bool] = False
    """True if its angles and moments are such at a joint that slides, too."""
    priors_along: ClassVar[bool] = False
    """True if the numbers of its priors hold for a joint that slides as they are."""

    varies_with: ClassVar[Literal["angle", "rate", "torque", "time"]] = "angle"
    """State of a joint against which a figure shows its law best."""

    @classmethod
    def only_in_motion(cls) -> bool:
        """Return True if poses show none of its parameters."""
        return bool(cls.in_motion) and cls.model_fields.keys() - {"at", "channels"} <= set(cls.in_motion)
