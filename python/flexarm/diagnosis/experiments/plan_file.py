"""`plan.json`: a plan for programs."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from flexarm.diagnosis.choosing.acceptance import REACH, STRONG
from flexarm.diagnosis.experiments.plan_result import FAR

if TYPE_CHECKING:
    from flexarm.diagnosis.experiments.plan_result import Plan, Tie

FORMAT = "flexarm-plan/1"


def plan_dict(plan: Plan) -> dict[str, Any]:
    """The object of the file; what is infinite becomes null."""
    return {
        "format": FORMAT,
        "model": plan.arm.name,
        "runs": list(plan.runs),
        "assumed": list(plan.assumed),
        "thresholds": {"detected": STRONG, "parted": REACH},
        "effects": [
            {
                "name": each.name,
                "at": each.at,
                "parameter": each.parameter,
                "unit": each.unit,
                "value": _finite(each.value),
                "null": _finite(each.null),
                "smallest_detectable": _finite(each.least) if each.times <= FAR else None,
                "log_bayes_factor": _finite(each.log_bayes_factor),
                "seen": each.seen,
                "hidden": each.hidden,
            }
            for each in plan.effects
        ],
        "log_bayes_factor": [[_finite(x) for x in row] for row in plan.log_bayes_factor],
        "groups": [
            [{"name": plan.effects[i].name, "at": plan.effects[i].at} for i in group] for group in plan.groups
        ],
        "ties": [_tie(each) for each in plan.ties],
        "provenance": dict(plan.provenance),
    }


def _tie(tie: Tie) -> dict[str, Any]:
    return {
        "effects": [{"name": name, "at": at} for name, at in (tie.one, tie.other)],
        "log_bayes_factor": _finite(tie.log_bayes_factor),
        "additions": [
            {
                "addition": each.addition,
                "minutes": each.minutes,
                "log_bayes_factor": _finite(each.log_bayes_factor),
                "parts": each.parts,
            }
            for each in tie.partings
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
