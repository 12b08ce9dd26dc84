"""Laws that act through a joint's spring, probed anew once a rigid joint has one.

A motor turns a rigid joint whatever rubs or pulls there: friction, play or a cable move nothing in a model
without a spring, and their probes about it (`choosing.screen`) are empty. Beside a spring that was found they
are simulated about the model with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import isinf

import numpy as np

from flexarm.diagnosis.candidates.candidate import Candidate, value_of
from flexarm.diagnosis.choosing.screen import LONGER, Probed
from flexarm.diagnosis.fitting.fit import FAILED, Fit
from flexarm.diagnosis.fitting.fitter import Fitter

THROUGH_SPRINGS = (
    "backlash",
    "cable_torque",
    "coulomb_friction",
    "joint_hysteresis",
    "joint_stiffening",
    "viscous_friction",
)


def new_springs(fit: Fit) -> frozenset[str]:
    """Joints that are rigid in the nominal model and have a spring in a fit."""
    return frozenset(m.at for m in fit.members if m.name == "joint_compliance" and _rigid(m))


def awakened(fitter: Fitter, probed: Sequence[Probed], fit: Fit) -> list[Probed]:
    """The same probes, those of laws through the new springs of a fit about its model."""
    joints = new_springs(fit)
    sleeping = [p for p in probed if p.candidate.name in THROUGH_SPRINGS and p.candidate.at in joints]
    if not sleeping:
        return list(probed)
    coarse = replace(fitter, observed=fitter.observed.with_step(LONGER * fitter.observed.step))
    found = {id(each): probed_beside(coarse, each, fit) for each in sleeping}
    return [found.get(id(each), each) for each in probed]


def probed_beside(fitter: Fitter, probed: Probed, fit: Fit) -> Probed:
    """A candidate about a model; as it was where that cannot be simulated."""
    observed = fitter.observed
    with suppress(*FAILED):
        arm = fitter.with_effects(fit.members)
        models = [arm.with_effect(probe) for probe in probed.candidate.probes]
        observed.prepare([arm, *models])
        before = observed.residual(arm)
        return replace(probed, moves=np.stack([observed.residual(each) - before for each in models], axis=1))
    return probed


def _rigid(spring: Candidate) -> bool:
    return spring.without is None or isinf(value_of(spring.without, "stiffness"))
