"""Remarks on initial transients, stated noise, unused signals and payload masses.

What is said of signals and loads that a fit takes otherwise than a reader may think, or does not see.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from flexarm.comparison.alignment_parameters import has_noise, uncertain_clock_and_frame
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.nuisance import known_loads
from flexarm.diagnosis.problem import Problem
from flexarm.record import Signal
from flexarm.wording import listed, with_unit

TOLD = 1.0
"""Least swing that is told, over the noise."""


def initial_transients(fit: Fit, problem: Problem) -> Iterator[str]:
    """Return a sentence for each record that begins with the arm swinging, which the gaps of a report still
    hold.
    """
    x = fit.projection.solve(fit.residual)
    for name in problem.records:
        mine = [fit.nuisance.keys.index(s.key) for s in problem.initial_conditions if s.record == name]
        move = fit.projection.jacobian[:, mine] @ x[mine]
        most = {each: float(np.abs(move[each.where]).max()) for each in problem.rows_of(name)}
        each = max(most, key=lambda rows: most[rows], default=None)
        if mine and each is not None and most[each] > TOLD:
            unit = problem.records[name].signals[each.signal].unit
            size = with_unit(most[each] * each.sigma, unit)
            yield (
                f"{name} begins with the arm swinging, by up to {size} at {each.signal}: that is fitted "
                "along, and still part of the gaps told here"
            )


_SILENT = "no noise is stated, and its values are too few or too even to show it"


def unweighed(problem: Problem) -> Iterator[str]:
    """Return a sentence for each signal without a stated noise: what stands for it, what is not aligned by
    it.
    """
    shown: dict[str, float] = {}
    for rows in problem.rows:
        if not has_noise(_signal(problem, rows.record, rows.signal).noise_std):
            shown[rows.signal] = max(shown.get(rows.signal, 0.0), rows.sigma)
    for name, sigma in shown.items():
        own = [(each, each.signals[name]) for each in problem.records.values() if name in each.signals]
        places = list(
            dict.fromkeys(
                place for record, signal in own for place in uncertain_clock_and_frame(record, signal)
            )
        )
        noise = with_unit(sigma, own[0][1].unit, 2)
        text = f"no noise is stated for {name}: the {noise} that its values show count instead"
        if places:
            text += f"; the gaps before and after are not aligned by it, in {listed(places)}"
        yield text


def unfitted(problem: Problem, compared: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Return a sentence for each signal that a simulation predicts and of which no value is fitted.

    Parameters
    ----------
    problem : Problem
        Records and their rows.
    compared : dict of str to sequence of str
        By record the signals that the model predicts.
    """
    seen = {(rows.record, rows.signal) for rows in problem.rows}
    for record in problem.records:
        for name in compared.get(record, ()):
            if (record, name) not in seen:
                stated = has_noise(_signal(problem, record, name).noise_std)
                why = "none of its values lies in the time of the drives" if stated else _SILENT
                yield f"{record}: {name} is not fitted: {why}"


def weighed_loads(problem: Problem) -> Iterator[str]:
    """Return a sentence for each payload of which the records state the mass and the model an uncertainty."""
    for load in known_loads(problem.arm, problem.records):
        yield (
            f"the mass of {load} is what the records state, and its uncertainty in the model has no part: "
            "if it was weighed wrongly, leave it out of the records, or other effects stand in for it"
        )


def _signal(problem: Problem, record: str, name: str) -> Signal:
    return problem.records[record].signals[name]
