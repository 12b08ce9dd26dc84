r"""The few cells that say most of where a gap is.

For each part of the gap (signal, direction, band) one line. When it occurs is said by

    a reversal    if the gap jumps with the sign of a joint's torque or rate: the mean on either side
                  explains most of it, and about as much as a curve over the state; of all bands
                  together, for a jump is in all of them, or of this one, if others ring;
    a condition   if its squares crowd in it: s of the squares in p of the samples, and
                  s ln(s/p) + (1 - s) ln((1 - s)/(1 - p)) >= `CROWDED`                                (1)
    throughout    else, with the state that it follows, if it follows one.

(1) is the information [Kullback1951] that the condition gives on where the squares are.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from flexarm.diagnosis.gap.cells import WHOLE, Cell
from flexarm.diagnosis.gap.conditions import tiers
from flexarm.diagnosis.gap.curves import CONSTANT, Followed, followed
from flexarm.diagnosis.gap.gap_rows import GapRows

CROWDED = 0.15
FOLLOWS = 0.5
"""Share of what is not constant that a state must explain to be named."""
SMALL = 0.02
"""Share of its signal's squared gap below which a part is not listed."""
BESIDE = 0.1
"""Share of a signal's largest part in a band below which its other directions are not listed."""
LINES = 8
"""Most lines; the largest part of every signal comes before the second of another."""
JUMPS = {"sign of torque": "torque", "sense of motion": "motion"}
"""States that jump, and what reverses then."""


def telling(gaps: Sequence[GapRows], cells: Iterable[Cell]) -> tuple[Mapping[str, Any], ...]:
    """The entries `where` of a report: signal, direction, when, band_hz, rms, noise_rms; largest first."""
    by_part: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        by_part.setdefault((cell.signal, cell.direction, cell.band), []).append(cell)
    rows = {each.signal: each for each in gaps}
    listed = _listed([next(cell for cell in found if cell.when == WHOLE) for found in by_part.values()])
    return tuple(
        _line(rows[cell.signal], cell, by_part[cell.signal, cell.direction, cell.band]) for cell in listed
    )


def _listed(parts: Sequence[Cell]) -> list[Cell]:
    """The parts that are worth a line, largest share first."""
    ranks: dict[str, int] = {}
    found = []
    for cell in sorted(parts, key=lambda cell: -cell.share):
        own = [other for other in parts if other.signal == cell.signal]
        total = sum(other.share for other in own)
        largest = max(other.share for other in own if other.band == cell.band)
        if cell.exceeds and cell.share >= max(SMALL * total, BESIDE * largest):
            found.append((ranks.setdefault(cell.signal, 0), cell))
            ranks[cell.signal] += 1
    kept = sorted(found, key=lambda item: (item[0] > 0, -item[1].share))[:LINES]
    return sorted((cell for _, cell in kept), key=lambda cell: -cell.share)


def _line(rows: GapRows, whole: Cell, cells: Sequence[Cell]) -> Mapping[str, Any]:
    """One entry."""
    part = next(each for each in rows.parts[whole.direction] if each.band == whole.band)
    groups, noise = tiers(rows.states, rows.time, rows.record), rows.noise[whole.direction]
    jumps = followed(groups, (rows.directions[whole.direction] / noise)[:, None])
    said, cell = _when(jumps, followed(groups, (part.values / noise)[:, None]), whole, cells)
    return {
        "signal": cell.signal,
        "direction": cell.direction,
        "when": said,
        "band_hz": [cell.band_hz[0], cell.band_hz[1]],
        "rms": cell.rms,
        "noise_rms": cell.noise_rms,
    }


def _when(jumps: Followed, follows: Followed, whole: Cell, cells: Sequence[Cell]) -> tuple[str, Cell]:
    """Wording, and the cell whose measures go with it."""
    for kind, state in JUMPS.items():
        for each in (jumps, follows):
            if each.best.startswith(kind) and each.beyond[each.best] >= FOLLOWS:
                return f"{state} reversal{each.best.removeprefix(kind)}", whole
    crowded = max(cells, key=lambda cell: crowding(cell, whole))
    if crowding(crowded, whole) >= CROWDED and crowded.exceeds:
        return crowded.when, crowded
    if follows.best != CONSTANT and follows.beyond[follows.best] >= FOLLOWS:
        return f"{WHOLE}, follows {follows.best}", whole
    return f"{WHOLE}, constant" if follows.constant >= FOLLOWS else WHOLE, whole


def crowding(cell: Cell, whole: Cell) -> float:
    """Information (1) of a condition; 0 where the squares are fewer than the samples."""
    if cell.state == "all" or whole.share <= 0:
        return 0.0
    s, p = cell.share / whole.share, cell.samples / whole.samples
    if s <= p or p >= 1:
        return 0.0
    rest = (1 - s) * np.log((1 - s) / (1 - p)) if s < 1 else 0.0
    return float(s * np.log(s / p) + rest)  # eq. (1)
