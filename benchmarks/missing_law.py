"""Missing laws of causes outside the vocabulary: python benchmarks/missing_law.py --seed 20 --draws 4

Records come from an integrator that is no part of flexarm (`tests/helpers/hidden_pendulum.py`). Each draw
takes the size of a cause from half to one and a half of its own, and clock and load from what is stated.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))
import hidden_causes as causes
from hidden_causes import Hidden
from hidden_pendulum import STIFFNESS, Study

from flexarm.law_curve import LawCurve

Draw = Callable[[np.random.Generator], Hidden]
LAWS = ("softening", "loose", "rubbing", "cogging", "bumper", "saturating", "stribeck", "cable", "presliding")


def _size(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.5, 1.5))


def _draws() -> dict[str, Draw]:
    """Return causes by name."""
    found: dict[str, Draw] = {
        name: lambda rng, name=name: getattr(causes, name)(_size(rng)) for name in (*LAWS, "warming")
    }
    return {
        **found,
        "softer after": lambda rng: causes.softer_after(rng.uniform(6, 14), 0.2 * _size(rng)),
        "dragging after": lambda rng: causes.dragging_after(rng.uniform(6, 14), _size(rng)),
        "gusts": lambda rng: causes.gusts(rng, _size(rng)),
        "nothing": lambda rng: causes.NOTHING,
    }


@dataclass(frozen=True)
class Outcome:
    """What was told of a cause; curves are compared over the states that they span.

    Attributes
    ----------
    cause, kind : str
        Name of the cause, and the kind that is told.
    place, state, named : bool
        True if the hinge is shown, a law over the hidden state comes first, and the kind is right.
    error, cover : float
        Greatest error of the curve over its peak, and the part of its knots in the band; nan without a curve.
    closed : float
        Part of the held-out gap above the noise that the first law closes; nan if it is not simulated.
    added : bool
        True if the updated model has it.
    seconds : float
        CPU time [s].
    """

    cause: str
    kind: str
    place: bool
    state: bool
    named: bool
    error: float
    cover: float
    closed: float
    added: bool
    seconds: float


def outcome(cause: str, hidden: Hidden, seed: int) -> Outcome:
    """Infer what is missing of a cause."""
    study = Study.of(hidden.cause, seed)
    begun = process_time()
    laws = study.laws()
    seconds = process_time() - begun
    if not laws.curves:
        return Outcome(cause, "", False, False, not hidden.kind, np.nan, np.nan, np.nan, False, seconds)
    first = laws.curves[0]
    error, cover = _curve(first, hidden)
    gap, closed = first.held_out, np.nan
    if gap.before_rms and gap.after_rms and gap.noise_rms:
        closed = (gap.before_rms - gap.after_rms) / (gap.before_rms - gap.noise_rms)
    return Outcome(
        cause,
        first.kind,
        any(each.at == "hinge" for each in laws.curves),
        first.of == hidden.of,
        first.kind == hidden.kind,
        error,
        cover,
        closed,
        laws.added is not None,
        seconds,
    )


def _curve(law: LawCurve, hidden: Hidden) -> tuple[float, float]:
    if hidden.curve is None or law.of != hidden.of or law.kind != hidden.kind:
        return np.nan, np.nan
    value, low, high = (np.array(each) for each in (law.value, law.low90, law.high90))
    truth = hidden.curve(np.array(law.x))
    if law.quantity != hidden.quantity:
        truth = truth * (-STIFFNESS if law.quantity == "torque" else -1 / STIFFNESS)
    error = np.abs(value - truth).max() / np.abs(truth).max()
    return float(error), float(np.mean((low <= truth) & (truth <= high)))


def rows(found: Iterable[Outcome]) -> Iterator[str]:
    """Yield a table in Markdown; errors, parts and closed gaps are medians."""
    found = list(found)
    titles = [
        "hidden cause",
        "draws",
        "place",
        "state",
        "kind",
        "added",
        "error",
        "in the band",
        "closed",
        "CPU s",
    ]
    yield f"| {' | '.join(titles)} |"
    yield "|---" * len(titles) + "|"
    for cause in dict.fromkeys(each.cause for each in found):
        of = [each for each in found if each.cause == cause]
        counts = [sum(getattr(o, key) for o in of) for key in ("place", "state", "named", "added")]
        error, cover, closed = (_median(getattr(o, key) for o in of) for key in ("error", "cover", "closed"))
        mean = np.mean([o.seconds for o in of])
        cells = (cause, len(of), *counts, error, cover, closed, f"{mean:.1f}")
        yield f"| {' | '.join(map(str, cells))} |"


def _median(values: Iterable[float]) -> str:
    known = [value for value in values if np.isfinite(value)]
    return f"{np.median(known):.2f}" if known else ""


def main() -> None:
    """Draw causes, infer, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--causes", nargs="*")
    told = parser.parse_args()
    found = []
    for name, draw in _draws().items():
        if told.causes and name not in told.causes:
            continue
        for k in range(told.draws):
            seed = 1000 * told.seed + k
            found.append(outcome(name, draw(np.random.default_rng(seed)), seed))
            print(found[-1], file=sys.stderr, flush=True)
    print(*rows(found), sep="\n")
    covers = [each.cover for each in found if np.isfinite(each.cover) and each.kind == "law"]
    if covers:
        print(f"\nknots in the 90 % band, {len(covers)} laws: mean {np.mean(covers):.2f}")


if __name__ == "__main__":
    main()
