"""Diagnoses of a study: one of each case's records, which machines and days may be.

A diagnosis keeps its verdict, the main signal's gap before and after, and of each effect, by the key
`effects.NAME.PLACE`, its probability and its parameters with 1 sigma. Which effects are found is known at the
end only: where a diagnosis has not found one that others have, its numbers are missing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flexarm.arm import Arm
from flexarm.campaigns.cases import Case
from flexarm.campaigns.outcome import Outcome, Prepared, Runner, Value, Variable
from flexarm.campaigns.study import Study
from flexarm.record import Record

VERDICT = Variable("verdict", "", "verdict of the diagnosis")


@dataclass
class DiagnoseRun(Runner):
    """Diagnoses of the records of all cases."""

    cases: tuple[Case, ...]
    step: float
    alpha: float
    seed: int
    max_seconds: float | None
    variables: tuple[Variable, ...] = (VERDICT,)

    def nominal(self, arm: Arm) -> list[Outcome]:
        """Return nothing: a diagnosis compares with records."""
        return []

    def outcome(self, arm: Arm, case: int) -> Outcome:
        """Return what one diagnosis found."""
        from flexarm.diagnosis.workflow import diagnose

        files, held = self.cases[case].files, self.cases[case].hold_out
        found = diagnose(
            arm,
            {f"{k} {path.name}": Record.load(path) for k, path in enumerate(files)},
            hold_out=None if held is None else Record.load(held),
            n_jobs=1,
            seed=self.seed,
            step=self.step,
            alpha=self.alpha,
            max_seconds=self.max_seconds,
        )
        report = found.to_json_dict()
        kept: dict[str, Value] = {"verdict": found.verdict}
        for part in ("train", "held_out"):
            for when in ("before", "after"):
                if (value := (report["gap"].get(part) or {}).get(f"{when}_rms")) is not None:
                    kept[f"gap_{part}_{when}_rms"] = float(value), report["gap"]["unit"]
        for effect in report["effects"]:
            at = effect["at"] if isinstance(effect["at"], str) else "+".join(effect["at"])
            stem = f"effects.{effect['name']}.{at}"
            kept[f"{stem}.probability"] = float(effect["probability"]), "-"
            for each in effect["parameters"]:
                kept |= _estimate(f"{stem}.{each['name']}", each, each["unit"])
        for each in found.refined:
            kept |= _estimate(f"refined.{each.parameter}", vars(each), each.unit)
        return kept


def _estimate(name: str, entry: Mapping[str, Any], unit: str) -> dict[str, Value]:
    """Return value and 1 sigma of an estimate."""
    return {name: (float(entry["value"]), unit), f"{name}.std": (float(entry["std"]), unit)}


def diagnose_run(study: Study, cases: tuple[Case, ...]) -> Prepared:
    """Return the diagnoses of a study."""
    seed = study.sampling.seed if study.sampling else 0
    return DiagnoseRun(cases, study.step, study.alpha, seed, study.max_seconds), []
