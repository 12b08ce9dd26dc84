r"""Who bends: the tip error split into hinge and tube, and how well the data separate the two.

With e_h(φ) and e_t(φ) the quasi-static tangential offsets with only the hinge or only the tube elastic, the
measured one is

    e = a e_h + b e_t + noise                                                                         (1)

a and b scale the compliance of hinge and tube. Both curves follow sin φ, and their correlation over the run
tells how far (1) can be solved: the standard deviation of a is

    s_a = s / sqrt(Σ e_h² (1 - ρ²)),    ρ = Σ e_h e_t / sqrt(Σ e_h² Σ e_t²)                            (2)

s is the rms of what (1) leaves: it holds the oscillations and the friction that (1) does not know, and its
neighbouring samples are not independent, so the true s_a is larger still. The plain test of the same: two
models with only one elastic part, its compliance fitted, beside the one with both.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.drive import Drive
from flexarm.effects import JointCompliance
from flexarm.report.oscillation import length_rms, rms
from flexarm.report.study import LATE, STIFF, Study, tube_of, with_modulus
from flexarm.simulation import simulate


@dataclass(frozen=True)
class Split:
    """Shares, and what the data say about them.

    Attributes
    ----------
    hinge_share, tube_share : float
        Of the greatest quasi-static tip error, with the other part rigid; both are shares of the error with
        both parts elastic, and add up to 1 but for their interaction.
    hinge_max_m, tube_max_m, both_max_m : float
        These errors [m].
    correlation : float
        rho of (2).
    hinge_share_std : float
        Of the share of the hinge, from (2).
    only_hinge_rms_m, only_tube_rms_m, both_rms_m : float
        Rms gap to the measured tip of models with only the hinge or only the tube elastic, their compliance
        fitted to the measured tip, and of the model with both, nothing fitted [m].
    only_hinge_stiffness, only_tube_modulus : float
        What was fitted [N m/rad], [Pa].
    """

    hinge_share: float
    tube_share: float
    hinge_max_m: float
    tube_max_m: float
    both_max_m: float
    correlation: float
    hinge_share_std: float
    only_hinge_rms_m: float
    only_tube_rms_m: float
    both_rms_m: float
    only_hinge_stiffness: float
    only_tube_modulus: float

    def to_dict(self) -> dict[str, float]:
        """For `summary.json`."""
        return {name: float(value) for name, value in asdict(self).items()}


def split(study: Study) -> Split:
    """The split of a study's tip error."""
    angle = study.angle(study.stamps)
    e = study.measured_tangential
    e_h, e_t, e_both = (study.static[part](angle) for part in ("hinge", "tube", "both"))
    largest = int(np.argmax(np.abs(e_both)))

    (a, b), *_ = np.linalg.lstsq(np.stack([e_h, e_t], 1), e, rcond=None)  # eq. (1)
    s = rms(e - a * e_h - b * e_t)
    rho = float(e_h @ e_t / np.sqrt(e_h @ e_h * (e_t @ e_t)))
    a_std = s / np.sqrt(e_h @ e_h * (1 - rho**2))  # eq. (2)
    share = e_h[largest] / e_both[largest]

    hinge_only, stiffness = _only_hinge(study.model, float(e @ e_h / (e_h @ e_h)))
    tube_only, modulus = _only_tube(study.model, float(e @ e_t / (e_t @ e_t)))
    return Split(
        hinge_share=float(share),
        tube_share=float(e_t[largest] / e_both[largest]),
        hinge_max_m=float(np.abs(e_h).max()),
        tube_max_m=float(np.abs(e_t).max()),
        both_max_m=float(np.abs(e_both).max()),
        correlation=rho,
        hinge_share_std=float(share * a_std),
        only_hinge_rms_m=_gap(study, hinge_only),
        only_tube_rms_m=_gap(study, tube_only),
        both_rms_m=length_rms(study.measured - study.tip("fe", study.stamps)),
        only_hinge_stiffness=stiffness,
        only_tube_modulus=modulus,
    )


def _only_hinge(arm: Arm, factor: float) -> tuple[Arm, float]:
    """The model with a rigid tube and the hinge's compliance times a factor; and its stiffness [N m/rad]."""
    compliance = arm.effect("joint_compliance", "hinge")
    assert isinstance(compliance, JointCompliance)
    stiffness = compliance.stiffness / factor
    softer = arm.with_effect(compliance.replace(stiffness=stiffness, damping=compliance.damping / factor))
    return with_modulus(softer, STIFF), stiffness


def _only_tube(arm: Arm, factor: float) -> tuple[Arm, float]:
    """The model with a rigid hinge and the tube's compliance times a factor; and its modulus [Pa]."""
    softer = with_modulus(arm.without_effect("joint_compliance", "hinge"), 1 / factor)
    return softer, tube_of(softer).material.youngs_modulus


def _gap(study: Study, arm: Arm) -> float:
    """Rms distance of the measured tip from that of a model driven by the encoder [m]."""
    run = simulate(arm, Drive({"hinge": study.encoder}, end=study.experiment.end + LATE))
    return length_rms(study.measured - run.at(study.stamps, "tip")[:, [0, 2]])
