r"""The tip error split into hinge and tube, and how well the data separate the two.

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
from flexarm.reproduction.oscillation import length_rms, rms
from flexarm.reproduction.study import LATE, Study, tip_of
from flexarm.reproduction.variants import CONTRIBUTORS, HINGE, RIGID, tube_of
from flexarm.simulation import simulate


@dataclass(frozen=True)
class Split:
    """Shares, and how well the data determine them."""

    hinge_share: float
    tube_share: float
    """Of the greatest quasi-static tip error, with the other part rigid; both are shares of the error with
    both parts elastic, and add up to 1 but for their interaction."""
    housing_part: float
    reducer_part: float
    hub_part: float
    tube_part: float
    """Share of the greatest error that goes when that part alone is made rigid."""
    hinge_max_m: float
    tube_max_m: float
    both_max_m: float
    """These errors [m]."""
    correlation: float
    """rho of (2)."""
    hinge_share_std: float
    """Of the share of the hinge, from (2)."""
    only_hinge_rms_m: float
    only_tube_rms_m: float
    both_rms_m: float
    """Rms gap to the measured tip of models with only the hinge or only the tube elastic, their compliance
    fitted to the measured tip, and of the model with both, nothing fitted [m]."""
    only_hinge_stiffness: float
    only_tube_modulus: float
    """What was fitted [N m/rad], [Pa]."""

    def to_dict(self) -> dict[str, float]:
        """Return the entry of `summary.json`."""
        return {name: float(value) for name, value in asdict(self).items()}


def split(study: Study) -> Split:
    """Split a study's tip error."""
    angle = study.angle(study.stamps)
    e = study.measured_tangential
    e_h, e_t, e_both = (study.static[part](angle) for part in ("hinge", "tube", "both"))
    largest = int(np.argmax(np.abs(e_both)))

    (a, b), *_ = np.linalg.lstsq(np.stack([e_h, e_t], 1), e, rcond=None)  # eq. (1)
    s = rms(e - a * e_h - b * e_t)
    rho = float(e_h @ e_t / np.sqrt(e_h @ e_h * (e_t @ e_t)))
    a_std = s / np.sqrt(e_h @ e_h * (1 - rho**2))  # eq. (2)
    share = e_h[largest] / e_both[largest]

    of_hinge, of_tube = float(e @ e_h / (e_h @ e_h)), float(e @ e_t / (e_t @ e_t))
    models = study.models
    hinge_only = models.scaled({**dict.fromkeys(HINGE, of_hinge), "tube": RIGID})
    tube_only = models.scaled({**dict.fromkeys(HINGE, RIGID), "tube": of_tube})
    return Split(
        hinge_share=float(share),
        tube_share=float(e_t[largest] / e_both[largest]),
        **{f"{part}_part": _part(study, part, angle[largest]) for part in CONTRIBUTORS},
        hinge_max_m=float(np.abs(e_h).max()),
        tube_max_m=float(np.abs(e_t).max()),
        both_max_m=float(np.abs(e_both).max()),
        correlation=rho,
        hinge_share_std=float(share * a_std),
        only_hinge_rms_m=_gap(study, hinge_only),
        only_tube_rms_m=_gap(study, tube_only),
        both_rms_m=length_rms(study.measured - study.tip("fe", study.stamps)),
        only_hinge_stiffness=models.hinge.stiffness / of_hinge,
        only_tube_modulus=tube_of(tube_only).material.youngs_modulus,
    )


def _part(study: Study, part: str, angle: float) -> float:
    """Return the share of the quasi-static error at an angle that a part's elasticity makes."""
    without, with_it = study.static[f"without {part}"], study.static["both"]
    at = np.array([angle])
    return 1 - float(without(at)[0] / with_it(at)[0])


def _gap(study: Study, arm: Arm) -> float:
    """Return the rms distance of the measured tip from that of a model driven by the encoder [m]."""
    # Step of the two trial models [s]: 0.03 mm off, beside gaps of half a millimetre and more.
    coarse_step = 4e-3
    moved = Drive({"hinge": study.encoder}, end=study.experiment.end + LATE)
    run = simulate(arm, moved, step=coarse_step)
    return length_rms(study.measured - tip_of(run, study.stamps))
