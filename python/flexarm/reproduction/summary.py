"""`summary.json`: parameters, figures, claims, and the gaps of all models."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.mockup import PARAMETER_SETS, mock_up, model
from flexarm.reproduction.claims import Claim
from flexarm.reproduction.oscillation import length_rms
from flexarm.reproduction.study import Study
from flexarm.reproduction.tables import Table
from flexarm.reproduction.variants import RUNS, tube_of

MODELS = {
    "rigid": "rigid arm at the encoder's angle",
    "equation 2": "equation (2), linear modal",
    "equation 1": "equation (1), nonlinear modal",
    "fe": RUNS["fe"],
    "friction": RUNS["friction"],
    "printed": RUNS["printed"],
}
"""Models whose gap to the measured tip is told."""


def summary(study: Study, tables: dict[str, Table], found: list[Claim], seed: int) -> dict[str, Any]:
    """Return the content of `summary.json`; nothing in it depends on the machine's speed."""
    return {
        "parameters": parameters(study, seed),
        "figures": {
            number: {
                "csv": f"figure-{number}.csv",
                "columns": {name: column.text for name, column in table.items()},
            }
            for number, table in tables.items()
        },
        "claims": [claim.to_dict() for claim in found],
        "models": gaps(study),
        "misprint": misprint(study),
    }


def parameters(study: Study, seed: int) -> dict[str, Any]:
    """Return the parameters of the runs, SI units."""
    asked, bench = study.experiment, mock_up()
    hinge = study.models.hinge
    tracker = study.record.signals["tip"]
    ratio = study.model.gears[0].ratio
    encoder = next(sensor for sensor in bench.sensors if sensor.name == "encoder")
    controller: Any = bench.controllers[0]
    return {
        "parameter_set": "consistent",
        "parameter_sets": {name: _tube(model(name)) for name in PARAMETER_SETS},
        "load_mass_kg": next(load.mass for load in study.model.payloads if load.name == "load"),
        "gear_ratio": ratio,
        "amplitude_rad": asked.amplitude,
        "period_s": asked.period,
        "duration_s": asked.duration,
        "rest_after_s": asked.rest,
        "posture": "hanging" if asked.hanging else "upright",
        "command_sample_time_s": asked.sample_time,
        "hinge_stiffness_Nm_per_rad": hinge.stiffness,
        "bench_hinge_stiffness_Nm_per_rad": study.models.bench_hinge.stiffness,
        "hinge_damping_Nms_per_rad": hinge.stiffness * hinge.design.damping_time.reducer,
        "hinge_parts": {
            name: {
                "points": study.models.hinge.meshes[name].n_points,
                "interfaces": list(part.interfaces),
                "modes": part.n_modes,
                "mass_kg": part.mass_total,
            }
            for name, part in hinge.parts.items()
        },
        "first_mode_hz": study.frequency_hz["fe"],
        "first_mode_damping_ratio": study.damping_ratio["fe"],
        "encoder_steps_a_motor_turn": round(2 * np.pi / (encoder.step * ratio)),
        "controller": controller.to_plain(),
        "tracker_noise_std_m": tracker.noise_std,
        "tracker_rate_hz": round(tracker.rate_hz, 6),
        "measured": "virtual: simulated on the virtual mock-up, the authors' data are not public",
        "seed": seed,
    }


def gaps(study: Study) -> dict[str, dict[str, float | str]]:
    """Return the distance of the measured tip from that of every model [m]."""
    found: dict[str, dict[str, float | str]] = {}
    for name, text in MODELS.items():
        tip = study.rigid(study.stamps) if name == "rigid" else study.tip(name, study.stamps)
        off = study.measured - tip
        found[name] = {"text": text, "rms_m": length_rms(off), "max_m": float(np.hypot(*off.T).max())}
    return found


def misprint(study: Study) -> dict[str, float]:
    """Return what Table 1's printed area would change."""
    error = {
        name: float(np.abs(study.tangential(run, study.stamps)).max())
        for name, run in (("consistent", "fe"), ("printed", "printed"))
    }
    return {
        "consistent_area_m2": tube_of(study.model).section.area,
        "printed_area_m2": tube_of(model("printed")).section.area,
        "consistent_rod_kg": _mass(model()),
        "printed_rod_kg": _mass(model("printed")),
        "consistent_tip_error_max_m": error["consistent"],
        "printed_tip_error_max_m": error["printed"],
        "consistent_first_mode_hz": study.frequency_hz["fe"],
        "printed_first_mode_hz": study.frequency_hz["printed"],
    }


def _tube(arm: Arm) -> dict[str, float]:
    tube = tube_of(arm)
    return {
        "length_m": tube.length,
        "area_m2": tube.section.area,
        "second_moment_m4": tube.section.second_moments[0],
        "youngs_modulus_Pa": tube.material.youngs_modulus,
        "density_kg_per_m3": tube.material.density,
        "rod_mass_kg": _mass(arm),
    }


def _mass(arm: Arm) -> float:
    tube = tube_of(arm)
    return tube.length * tube.section.area * tube.material.density
