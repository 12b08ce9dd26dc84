"""A study made ready: its model, samples, cases and the job, or everything that is wrong with it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.campaigns.cases import Case, cases_of, label_names
from flexarm.campaigns.diagnose_run import diagnose_run
from flexarm.campaigns.job import Job, Task
from flexarm.campaigns.outcome import Prepared
from flexarm.campaigns.sampling import samples
from flexarm.campaigns.simulate_run import simulate_run
from flexarm.campaigns.still_run import modes_run, static_run
from flexarm.campaigns.study import Study, read_study
from flexarm.campaigns.variation import Variation, variation_of
from flexarm.errors import InvalidFile, Problem
from flexarm.input_files import hashes, model_files
from flexarm.tables import refuse

RESERVED = ("sample", "status", "reason", "seconds", "block", "time", "axis", "mode")
"""Names of variables that every file of results has."""


@dataclass(frozen=True)
class Plan:
    """A study that can be run."""

    file: Path
    """Of the study."""
    study: Study
    """Its tables."""
    arm: Arm
    """The nominal model."""
    job: Job
    """For the workers."""
    cases: tuple[Case, ...]
    """Drives or records; every variant runs through each."""
    values: Floats
    """Samples of the parameters. Shape (variants, parameters)."""
    remarks: tuple[Problem, ...]
    """What the user should know."""

    @property
    def count(self) -> int:
        """Number of samples: sample i is variant i % variants in case i // variants."""
        return len(self.cases) * len(self.values)

    @property
    def variation(self) -> Variation:
        """What varies."""
        return self.job.variation

    def tasks(self, pending: Sequence[int], size: int, workers: int) -> Iterator[Task]:
        """Yield the samples as tasks, see `cut`."""
        for first, last in cut(len(pending), size, workers):
            chosen = tuple(pending[first:last])
            rows = [sample % len(self.values) for sample in chosen]
            yield Task(chosen, tuple(sample // len(self.values) for sample in chosen), self.values[rows])

    @property
    def row_bytes(self) -> int:
        """Bytes of what is kept of one run."""
        return sum(8 * prod(each.shape) for each in self.job.runner.variables) or 8

    def coordinates(self) -> dict[str, tuple[Any, dict[str, Any]]]:
        """Return parameters and labels by sample, each with its attributes."""
        found: dict[str, tuple[Any, dict[str, Any]]] = {}
        for k, parameter in enumerate(self.variation.parameters):
            nominal = self.variation.nominal(parameter)
            about = {"units": parameter.unit} | ({} if nominal is None else {"nominal": nominal})
            found[parameter.key] = np.tile(self.values[:, k], len(self.cases)), about
        for name in label_names(self.cases):
            found[name] = [case.labels.get(name, "") for case in self.cases for _ in self.values], {}
        if self.study.sampling is not None and self.study.sampling.saltelli:
            names = ["A", "B", *(f"AB:{key}" for key in self.variation.keys)]
            size = len(self.values) // len(names)
            found["block"] = [name for name in names for _ in range(size)] * len(self.cases), {}
        return found or {"case": (np.arange(self.count), {})}

    @property
    def inputs(self) -> dict[str, Path]:
        """Files that results depend on, by name from where the study lies."""
        folder = self.file.parent
        model = folder / self.study.model
        files = model_files(model, self.arm)
        for case in self.cases:
            for path in (*case.files, *([case.hold_out] if case.hold_out else [])):
                files += (
                    sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
                )
        return {
            path.relative_to(folder).as_posix() if path.is_relative_to(folder) else str(path): path
            for path in dict.fromkeys(files)
            if path.is_file()
        }

    def fingerprint(self) -> dict[str, Any]:
        """Return what makes this campaign the same one: the study's tables and the hashes of its inputs."""
        tables = self.study.to_plain()
        return {
            "study": tables,
            "study_sha256": hashlib.sha256(json.dumps(tables, sort_keys=True).encode()).hexdigest(),
            "inputs_sha256": hashes(self.inputs),
        }


def cut(count: int, size: int, workers: int) -> Iterator[tuple[int, int]]:
    """Yield begin and end of tasks of at most `size` runs, smaller ones at the end, so that all end together.

    A task is at most the part 1/(`tasks_left` workers) of what is left: guided self-scheduling
    (C. Polychronopoulos and D. Kuck, IEEE Transactions on Computers 36 (1987), 1425-1439).
    """
    tasks_left = 2  # tasks for each worker into which what is left could be cut at any time
    first = 0
    while first < count:
        last = first + max(1, min(size, (count - first) // (tasks_left * workers)))
        yield first, last
        first = last


def planned(file: Path) -> Plan:
    """Return the plan of a study.

    Raise InvalidFile with every problem of the study, or of a file that it names.
    """
    study, data, text = read_study(file)
    folder = file.parent
    if not (folder / study.model).is_file():
        refuse([(("model",), f"there is no {folder / study.model}")], data, file, text)
    arm = Arm.from_toml(folder / study.model)
    variation, found = variation_of(study, arm)
    cases, wrong = cases_of(study, folder)
    found += wrong
    if not wrong:
        runner, wrong = _runner(study, arm, cases)
        found += wrong
    told_by = "records" if study.run == "diagnose" else "drive"
    found += [
        ((told_by,), f"{{{name}}} is taken; use another word")
        for name in label_names(cases)
        if name in (*RESERVED, "case")
    ]
    taken = {"case", *RESERVED, *variation.keys, *label_names(cases)}
    found += [
        (("keep", i, "name"), f"{keep.variable!r} is taken; give it another name")
        for i, keep in enumerate(study.keep)
        if keep.variable in taken
    ]
    refuse(found, data, file, text)
    values = samples(study.sampling, variation.distributions, variation.levels)
    return Plan(file, study, arm, Job(variation, runner), cases, values, tuple(_remarks(study)))


def _runner(study: Study, arm: Arm, cases: tuple[Case, ...]) -> Prepared:
    if study.run == "simulate":
        return simulate_run(study, arm, cases)
    if study.run == "diagnose":
        return diagnose_run(study, cases)
    if study.run == "static":
        return static_run(study, arm)
    return modes_run(study, arm)


def _remarks(study: Study) -> Iterator[Problem]:
    sampling = study.sampling
    if sampling is not None and sampling.method == "sobol" and (n := sampling.n or 1) & (n - 1):
        low = 1 << (n.bit_length() - 1)
        what = f"{n} is no power of two; Sobol points are balanced at {low} and {2 * low}"
        yield Problem("sampling.n", what)


def refuse_other(plan: Plan, stored: Path, content: Any) -> None:
    """Refuse to go on with a campaign of another study, or of other inputs.

    Raise InvalidFile with the first key, or the files, that differ.
    """
    mine = plan.fingerprint()
    theirs = content if isinstance(content, dict) else {}
    allowed = "allowed is the study it was begun with, another directory, or --force to begin anew"
    old = theirs.get("study")
    if not isinstance(old, dict):
        raise InvalidFile(stored, "study", f"is missing; {allowed}")
    for key in sorted({*old, *mine["study"]}):
        if old.get(key) != mine["study"].get(key):
            what = f"was {_short(old.get(key))}, and is {_short(mine['study'].get(key))} now; {allowed}"
            raise InvalidFile(stored, f"study.{key}", what)
    before = theirs.get("inputs_sha256", {})
    for name in sorted({*before, *mine["inputs_sha256"]}):
        if before.get(name) != mine["inputs_sha256"].get(name):
            raise InvalidFile(stored, f"inputs_sha256.{name}", f"the file has changed since; {allowed}")


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
