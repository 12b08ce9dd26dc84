r"""Eccentricity of an encoder: its disc is mounted off the axis, an error once per turn of the output.

.. math:: \text{reading} = \text{true} + \text{amplitude} \, \sin(\text{true} + \text{phase})        (1)

A disc of radius r whose centre is off by e errs by amplitude = e/r.
"""

from __future__ import annotations

from math import pi
from typing import ClassVar

from flexarm.arm.arm import Arm
from flexarm.arm.prior import Prior
from flexarm.effects.periodic_encoder_error import PeriodicEncoderError
from flexarm.tables import Number, value_in


class EncoderEccentricity(PeriodicEncoderError):
    """Eccentricity of an encoder, once per output turn."""

    name = "encoder_eccentricity"
    order: ClassVar[float] = 1.0
    amplitude: Number = value_in("rad", "amplitude of the error once per output turn", 0.0, ge=0, lt=1)
    phase: Number = value_in("rad", "phase of the error at the true angle zero", 0.0)

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a disc that is mounted some micrometres off the axis."""
        mounting = "engineering judgement: discs of 10 to 100 mm radius are centred to 1 to 50 um"
        return {
            "amplitude": Prior(1e-5, 3e-3, 1.5e-4, "log", "rad", mounting),
            "phase": Prior(-pi, pi, 0.0, "uniform", "rad", "any angle"),
        }
