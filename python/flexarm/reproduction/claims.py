"""The paper's claims, each with a number computed from the runs, a threshold, its reason, and a verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flexarm.mockup import mock_up
from flexarm.reproduction.oscillation import GRID, grid, length_rms, oscillation, rms, start_time
from flexarm.reproduction.split import Split, split
from flexarm.reproduction.study import Study


@dataclass(frozen=True)
class Claim:
    """A claim and its check."""

    id: int
    claim: str
    """Number and text in the paper's list."""
    measure: str
    value: float
    unit: str
    """What `value` is, and its unit; "-" for a pure number."""
    threshold: float
    reason: str
    """The claim needs value >= threshold, or <= where `at_most`, and why."""
    at_most: bool = False
    numbers: dict[str, float] = field(default_factory=dict)
    """Further numbers behind the verdict; names end in their unit."""
    conditions: tuple[bool, ...] = ()
    """What must hold besides."""

    @property
    def holds(self) -> bool:
        """The verdict."""
        met = self.value <= self.threshold if self.at_most else self.value >= self.threshold
        return bool(met and all(self.conditions))

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of `summary.json`."""
        return {
            "id": self.id,
            "statement": f"{self.claim} (value: {self.measure})",
            "value": self.value,
            "unit": self.unit,
            "threshold": self.threshold,
            "needs": "at most" if self.at_most else "at least",
            "holds": self.holds,
            "reason": self.reason,
            "numbers": self.numbers,
        }


def claims(study: Study) -> list[Claim]:
    """Return all six claims."""
    makers: tuple[Callable[[Study], Claim], ...] = (agreement, direction, carrier, pure_sine, hinge, outlook)
    return [make(study) for make in makers]


def agreement(study: Study) -> Claim:
    """Check claim 1: model and measurement against the rigid position."""
    to_rigid = study.measured - study.rigid(study.stamps)
    to_model = study.measured - study.tip("fe", study.stamps)
    furthest = float(np.hypot(*to_rigid.T).max())
    return Claim(
        1,
        "Model and measurement agree far better with each other than with the rigid position, which is off "
        "by a few centimetres",
        "rms distance of the measured tip from the rigid one over that from the model",
        length_rms(to_rigid) / length_rms(to_model),
        "-",
        10.0,
        "far better: by an order of magnitude; and the rigid tip is off by 1 to 10 cm at most",
        numbers={
            "rigid_rms_m": length_rms(to_rigid),
            "rigid_max_m": furthest,
            "model_rms_m": length_rms(to_model),
            "model_max_m": float(np.hypot(*to_model.T).max()),
        },
        conditions=(0.01 <= furthest <= 0.1,),
    )


def direction(study: Study) -> Claim:
    """Check claim 2: the deformation is tangential."""
    angle = study.angle(study.stamps)
    across = rms(study.measured_tangential)
    along = rms(study.plane.radial(study.measured, angle))
    return Claim(
        2,
        "The deformation is essentially tangential",
        "tangential share of the mean square offset of the measured tip from the rigid one",
        across**2 / (across**2 + along**2),
        "-",
        0.99,
        "essentially: all but a hundredth, so that the radial offset is below a tenth of the tangential one",
        numbers={"tangential_rms_m": across, "radial_rms_m": along},
    )


def carrier(study: Study) -> Claim:
    """Check claim 3: a quasi-static carrier plus oscillations at the first mode."""
    measured, time = study.measured_tangential, study.stamps
    rest = measured - study.static["both"](study.angle(time))
    rate = study.record.signals["tip"].rate_hz
    frequency = _peak(rest, rate, study.frequency_hz["fe"] / 2)
    shaking = oscillation(measured, rate, study)
    quarter, end = study.experiment.period / 4, study.experiment.duration
    windows = {"start": 0.0, "reversal": quarter, "between": 0.6 * 2 * quarter + quarter, "stop": end}
    numbers = {
        f"oscillation_{name}_rms_m": rms(shaking[(time >= t) & (time < t + 5)]) for name, t in windows.items()
    }
    return Claim(
        3,
        "The error is a quasi-static carrier plus oscillations from start, stop and control",
        "share of the variance of the measured tangential error that equilibria of the model at the "
        "encoder's angle explain, nothing fitted",
        1 - float(np.var(rest) / np.var(measured)),
        "-",
        0.95,
        "carrier: all but a twentieth of the variance; and the rest has its spectral peak within a fifth of "
        "the first mode's frequency",
        numbers={
            "carrier_max_m": float(np.abs(study.static["both"](study.angle(time))).max()),
            "rest_rms_m": rms(rest),
            "peak_of_rest_hz": frequency,
            "first_mode_hz": study.frequency_hz["fe"],
            **numbers,
        },
        conditions=(abs(frequency / study.frequency_hz["fe"] - 1) < 0.2,),
    )


def pure_sine(study: Study) -> Claim:
    """Check claim 4: without the control there are no oscillations after the start."""
    time = grid(study)
    time = time[time < study.experiment.duration]  # a filter must not carry the stop backwards
    after = time > start_time(study)
    shaking = {run: oscillation(study.tangential(run, time), 1 / GRID, study) for run in ("fe", "sine")}
    left = {run: rms(values[after]) for run, values in shaking.items()}
    return Claim(
        4,
        "Driven by the pure sine, after the start the oscillations vanish: they come from the control scheme",
        "rms oscillation of the model under the pure sine over that under the encoder's signal, after the "
        "start",
        left["sine"] / left["fe"],
        "-",
        0.1,
        "vanish: below a tenth; after the start: once a free vibration has fallen to a thousandth",
        at_most=True,
        numbers={
            "encoder_rms_m": left["fe"],
            "sine_rms_m": left["sine"],
            "start_max_sine_m": float(np.abs(shaking["sine"][time < 5]).max()),
            "start_ends_s": start_time(study),
        },
    )


def hinge(study: Study) -> Claim:
    """Check claim 5: the hinge's part, and how far the data support it."""
    parts: Split = split(study)
    return Claim(
        5,
        "The elasticity of hinge and reducer is one of the major contributors",
        "their share of the tip error in the finite-element model, the tube made rigid; it rests on the "
        "assumed dimensions, and this record alone does not determine it",
        parts.hinge_share,
        "-",
        0.25,
        "major: at least half of an equal part of two contributors",
        numbers={**parts.to_dict(), "hinge_stiffness_Nm_per_rad": study.models.hinge.stiffness},
    )


def outlook(study: Study) -> Claim:
    """Check claim 6: a model with all active phenomena needs no mock-up."""
    gaps = {run: length_rms(study.measured - study.tip(run, study.stamps)) for run in ("fe", "friction")}
    bearing = {effect.name: effect for effect in mock_up().effects}
    return Claim(
        6,
        "Outlook: models with all phenomena that play an active part replace costly mock-ups",
        "rms gap to the measured tip with the bearing's friction in the model, as it is in the virtual "
        "mock-up, over that without",
        gaps["friction"] / gaps["fe"],
        "-",
        0.5,
        "an active part: at least half of what is left is this one phenomenon",
        at_most=True,
        numbers={
            "without_friction_rms_m": gaps["fe"],
            "with_friction_rms_m": gaps["friction"],
            "bearing_coulomb_Nm": float(getattr(bearing["coulomb_friction"], "torque", np.nan)),
            "tracker_noise_rms_m": float(np.sqrt(2) * (study.record.signals["tip"].noise_std or 0.0)),
        },
    )


def _peak(values: np.ndarray[Any, np.dtype[np.float64]], rate_hz: float, above_hz: float) -> float:
    """Return the frequency of the largest spectral line above a frequency [Hz]."""
    from scipy.signal import welch

    frequency, power = welch(values, rate_hz, nperseg=min(len(values), 256))
    beyond = frequency > above_hz
    return float(frequency[beyond][np.argmax(power[beyond])])
