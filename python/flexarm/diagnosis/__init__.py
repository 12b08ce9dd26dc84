"""Where simulation and measurement disagree, which effect is missing, and how the gap shrinks with it.

The steps of a diagnosis: `check` the sensors, pair a record with its simulation (`simulate_record`), find the
`noise_floor`, `localise` the residual, `diagnose` it, `plan` what to measure next.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from flexarm.comparison.aligned_record import simulate_record as simulate_record
    from flexarm.diagnosis.design.planning import plan as plan
    from flexarm.diagnosis.workflow import diagnose as diagnose
    from flexarm.residual_analysis.localisation import localise as localise
    from flexarm.residual_analysis.noise_floor import noise_floor as noise_floor
    from flexarm.validation.sensor_check import check as check

_STEPS = {
    "check": "flexarm.validation.sensor_check",
    "diagnose": "flexarm.diagnosis.workflow",
    "localise": "flexarm.residual_analysis.localisation",
    "noise_floor": "flexarm.residual_analysis.noise_floor",
    "plan": "flexarm.diagnosis.design.planning",
    "simulate_record": "flexarm.comparison.aligned_record",
}

__all__ = [*_STEPS]


def __getattr__(name: str) -> "Any":
    from importlib import import_module

    if name in _STEPS:
        return getattr(import_module(_STEPS[name]), name)
    raise AttributeError(f"module 'flexarm.diagnosis' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*_STEPS, *globals()})
