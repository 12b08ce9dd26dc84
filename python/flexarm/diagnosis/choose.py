"""Which effects: one after the other while they explain something real, then every one against its rivals.

An effect is taken if the evidence for it is strong and what it explains matters: it takes away more than half
of the noise of some channel and more than a twentieth of the gap there, or brings clocks, frames and nominal
values back from where their stated uncertainty forbids them. If it leaves a gap all the same, it must also
foretell data that are left out better than the smaller model does, and what foretells them clearly better
needs no other evidence, which rests on the size and correlation of a remainder that nobody knows. Rivals
beside such a gap are out of reach where they foretell clearly less. After each step derivatives are taken
anew about the better model. An effect that the others have made needless is dropped. Every rival of every
effect that is left is fitted in its place; those within `REACH` of the best are within reach of the data.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cmp_to_key
from math import exp, log

import numpy as np

from flexarm.diagnosis.candidates import SPRINGS, Candidate, value_of
from flexarm.diagnosis.companions import cardan_joints, causes, driven_joints
from flexarm.diagnosis.evidence import (
    Channel,
    above_noise,
    log_bayes_factor,
    log_likelihood_ratio,
    worth,
)
from flexarm.diagnosis.fit import Fit, Fitter
from flexarm.diagnosis.left_out import foretells_better, missed
from flexarm.diagnosis.observed import Observed
from flexarm.diagnosis.screen import NONE, Probed, Share, screen, sharpened, together
from flexarm.errors import InvalidParameter, NotConverged

STRONG = 6.0
"""Least gain of ln Z: odds of 400, for some forty effects at some places."""
MATTERS, SHARE = 0.5, 0.05
"""Least part explained in some channel: of the noise, and of what the nominal model leaves there."""
STRAINED, FORBIDDEN = 1.0, 2.0
"""Sum of the sigmas by which unknowns are beyond `FORBIDDEN` sigmas, from which they count as strained."""
LEFT = 1.0
"""What may be left above the noise of a model that explains a record, over the noise."""
LEFT_SHARE = 0.07
"""The same, of what the nominal model leaves."""
REACH = log(20.0)
"""Bayes factor within which rivals are alternatives; enough for an effect that spares a strain, too.

Values and clocks four sigma off are so few where nothing is hidden that no odds for many names are needed.
"""
CLOSE, WITHIN_SIGHT = 30.0, 8.0
"""How far behind a rival is fitted with derivatives of its own, and polished as the chosen one was."""
MOST = 3
"""Effects in one diagnosis."""
FAR = 0.3
"""Candidates that promise less than this part of the best are left out once one explains everything."""
ROUNDS, BETTER, QUIET = 6, 0.98, 0.4
"""Of `polished`: most rounds, what counts as less, and what is left above the noise where it ends."""
SETTLED = 1.0
"""Least fall of C in a round of `settled`: that of one sigma."""
ALIKE = 2
"""Rounds in which the model without effects is fitted about itself."""
OVERTAKEN = 3
"""Times that a rival may take the place of what was chosen."""
TRIED, PAIRS = 6, 3
"""Candidates that are fitted at each step, and sets of two or three where no smaller one explains all."""
AHEAD = 0.9
"""What a set of three may leave of what the best one leaves that only adds to a smaller set."""

Note = Callable[[str, float], object]


@dataclass(frozen=True, eq=False)
class Rival:
    """An effect in the place of another one, with the rest refitted.

    Attributes
    ----------
    candidate, fit : Candidate and Fit
        The effect, and the model with it.
    behind : float
        ln Z less than the chosen model's.
    fits_behind : float
        The same of the fit alone, whatever is plausible.
    foretells : bool
        Whether it says as much of data that are left out, where a gap is left.
    """

    candidate: Candidate
    fit: Fit
    behind: float
    fits_behind: float
    foretells: bool = True

    @property
    def within_reach(self) -> bool:
        """Whether the data cannot tell it from the chosen effect; what is implausible may still be true."""
        close = self.behind < REACH or (self.fits_behind < REACH and self.behind < 2 * REACH)
        return close and self.foretells


@dataclass(eq=False)
class Choice:
    """What was chosen.

    Attributes
    ----------
    null, best : Fit
        The nominal model and the chosen one; both with unknowns fitted.
    fitter : Fitter
        About the chosen model.
    value : dict
        Worth of the samples, T of `evidence`, after the chosen model.
    rivals : list of (list of Rival)
        For each effect of `best`, the best first.
    tried : list of (Fit, float)
        Every fit and its gain of ln Z over the nominal model.
    path : list of Fit
        From the nominal model to the chosen one, one effect more each.
    """

    null: Fit
    best: Fit
    fitter: Fitter
    value: Mapping[Channel, float]
    rivals: list[list[Rival]] = field(default_factory=list)
    tried: list[tuple[Fit, float]] = field(default_factory=list)
    path: list[Fit] = field(default_factory=list)

    @property
    def gain(self) -> float:
        """ln Z of the chosen model over the nominal one."""
        observed = self.fitter.observed
        return log_bayes_factor(self.best, self.null, observed, self.value)


def choose(fitter: Fitter, probed: Sequence[Probed], note: Note | None = None) -> Choice:
    """Forward, backward, and rivals."""
    observed = fitter.observed
    start = fitter.fit(())
    null = _best_without(start, fitter)
    best, about, path = null, fitter, [null]
    tried: list[Fit] = []
    places = cardan_joints(observed.arm, driven_joints(observed.arm, observed.records.values()))
    while causes(best.members, places) < MOST and not explained(best, null, observed):
        if note is not None:
            count = causes(best.members, places)
            note(f"looking for effect {count + 1}", count / (MOST + 1))
        here = best if best.members else start
        found = _step(about, probed, here, null, places=places)
        tried += found
        if not found:
            break
        better, there = _refined(about, found, best, null)
        for size in (2, 3):
            if best.members or explained(better, null, observed):
                break
            sets = _step(about, probed, here, null, size, beside=better)
            tried += sets
            if sets and accepted((more := _refined(about, sets, best, null))[0], better, null, observed):
                better, there = more
        if not accepted(better, best, null, observed):
            break
        best, about = better, there
        path.append(best)
    best, about = _backward(about, best, null)
    value = worth(best.rest, observed)
    if note is not None:
        note("weighing rivals", MOST / (MOST + 1))
    rivals = [_rivals(about, probed, best, null, k, tried, value) for k in range(len(best.members))]
    for _ in range(OVERTAKEN):
        ahead = min((r for each in rivals for r in each), key=lambda rival: rival.behind, default=None)
        if ahead is None or ahead.behind >= 0 or not ahead.foretells:
            break
        best, about = polished(ahead.fit, about.about(ahead.fit))
        value = worth(best.rest, observed)
        path = [*path[:-1], best]
        rivals = [_rivals(about, probed, best, null, k, tried, value) for k in range(len(best.members))]
    best, about = settled(best, about)
    gains = [(f, log_bayes_factor(f, null, observed, value)) for f in tried]
    return Choice(null, best, about, value, rivals, gains, path)


def _best_without(start: Fit, fitter: Fitter) -> Fit:
    """The nominal model about its own optimum, as fits with effects are; otherwise any effect seems better.

    The search itself starts where clocks and frames are nominal, since effects may take their places.
    """
    best, there = start, fitter
    for _ in range(ALIKE):
        there = there.about(best)
        fit = there.fit(())
        if fit.cost > BETTER * best.cost:
            return min(fit, best, key=lambda f: f.cost)
        best = fit
    return best


def explained(fit: Fit, null: Fit, observed: Observed) -> bool:
    """Whether nothing that matters is left above the noise, and no unknown is strained."""
    first = above_noise(null.rest, observed)
    left = above_noise(fit.rest, observed)
    quiet = all(left[c] <= max(MATTERS, LEFT_SHARE * first[c] / 2) for c in left)
    return quiet and strain(fit) < STRAINED


def leaves_gap(fit: Fit, null: Fit, observed: Observed) -> bool:
    """Whether a fit leaves so much that something else must be there."""
    first = max(above_noise(null.rest, observed).values())
    left = max(above_noise(fit.rest, observed).values())
    return left > max(LEFT, LEFT_SHARE * first)


def strain(fit: Fit) -> float:
    """By how many sigmas unknowns are beyond `FORBIDDEN` of them, summed."""
    z = np.abs(fit.projection.best(fit.residual)) / fit.unknowns.sigma
    return float(np.sum(np.maximum(z - FORBIDDEN, 0.0)))


def accepted(new: Fit, old: Fit, null: Fit, observed: Observed) -> bool:
    """Whether evidence for a larger model is strong and what it explains matters."""
    spared = strain(old) - strain(new) > STRAINED
    if not (matters(new, old, null, observed) or spared):
        return False
    enough = REACH if spared else STRONG
    strong = log_bayes_factor(new, old, observed, worth(new.rest, observed)) > enough
    if not leaves_gap(new, null, observed):
        return strong
    if strong:
        return missed(new, observed) < missed(old, observed)
    return foretells_better(new, old, observed)


def matters(new: Fit, old: Fit, null: Fit, observed: Observed) -> bool:
    """Whether a larger model explains a part of the gap that can be seen in some channel."""
    first = above_noise(null.rest, observed)
    for each, where in observed.channels():
        square = float(np.mean(old.rest[where] ** 2) - np.mean(new.rest[where] ** 2))
        part = np.sqrt(max(square, 0.0))
        if part > max(MATTERS, SHARE * first[each.record, each.signal, each.channel]):
            return True
    return False


def _step(
    fitter: Fitter,
    probed: Sequence[Probed],
    best: Fit,
    null: Fit,
    size: int = 1,
    places: Mapping[str, str] = NONE,
    beside: Fit | None = None,
) -> list[Fit]:
    """Fits of the most promising candidates, or sets of them, beside the effects that are there."""
    if size == 1:
        shares = _one_variant(screen(fitter, probed, best, places), len(probed))
        wanted = sharpened(fitter, shares[: 2 * TRIED], best)[:TRIED]
        if strain(best) > STRAINED:
            wanted += _relieving(shares, wanted)
    else:
        shares = together(fitter, probed, best, size)
        ahead = size == 2 or beside is None or _leads(shares, beside)
        wanted = _one_variant(shares, PAIRS) if ahead else []
    found: list[Fit] = []
    for share in wanted:
        done = any(explained(f, null, fitter.observed) for f in found)
        if done and share.share < FAR * wanted[0].share:
            break
        try:
            found.append(fitter.fit((*map(relaxed, best.members), *share.members)))
        except (InvalidParameter, NotConverged, ValueError):
            continue
    return found


def _relieving(shares: Sequence[Share], wanted: Sequence[Share]) -> list[Share]:
    """Those that need nominal values and nuisances least, beside what explains most of the gap."""
    there = {tuple(m.place for m in share.members) for share in wanted}
    others = [share for share in shares if tuple(m.place for m in share.members) not in there]
    return sorted(others, key=lambda share: -share.relief)[: TRIED // 2]


def _leads(shares: Sequence[Share], beside: Fit) -> bool:
    """Whether the best set goes where adding to a smaller one does not lead."""
    reached = max(
        (s.share for s in shares if set(beside.places) <= {m.place for m in s.members}), default=0.0
    )
    return bool(shares) and 1.0 - shares[0].share < AHEAD * (1.0 - reached)


def relaxed(member: Candidate) -> Candidate:
    """A spring with a typical damping: what it had may have stood in for the effect that is added."""
    if member.name not in SPRINGS or "damping" not in member.free:
        return member
    damping = 2e-3 * value_of(member.effect, "stiffness")
    return replace(member, effect=member.effect.with_parameters({"damping": damping}))


def _one_variant(shares: Sequence[Share], most: int) -> list[Share]:
    """The best variant of each, the best of those."""
    found: dict[tuple[tuple[str, str], ...], Share] = {}
    for share in shares:
        found.setdefault(tuple(sorted(m.place for m in share.members)), share)
    return list(found.values())[:most]


def _refined(fitter: Fitter, fits: Sequence[Fit], old: Fit, null: Fit) -> tuple[Fit, Fitter]:
    """The best fit, with derivatives taken anew about those that come close."""
    observed = fitter.observed
    first, *others = _ranked(fits, old, null, observed)
    close = [f for f in others[:2] if _close(f, first, observed)]
    there = {}
    for fit in (first, *close):
        about = fitter.about(fit)
        there[about.fit(fit.members)] = about
    best = _ranked(list(there), old, null, observed)[0]
    return polished(best, there[best])


def _ranked(fits: Sequence[Fit], old: Fit, null: Fit, observed: Observed) -> list[Fit]:
    """By evidence of each over each; where gaps are left and none is strong, by what is foretold.

    Beside the smaller model all of them differ by the whole gap, and the simulation's error would hide what
    they differ by.
    """
    value = worth(min(fits, key=lambda f: f.cost).rest, observed)

    def behind(one: Fit, other: Fit) -> int:
        return int(np.sign(log_bayes_factor(other, one, observed, value)))

    ranked = sorted(fits, key=cmp_to_key(behind))
    strong = log_bayes_factor(ranked[0], old, observed, value) > STRONG
    if strong or not all(leaves_gap(f, null, observed) for f in fits):
        return ranked
    return sorted(fits, key=lambda f: missed(f, observed))


def _close(fit: Fit, first: Fit, observed: Observed) -> bool:
    """Whether a fit may be as good as the first with derivatives of its own."""
    value = worth(min((fit, first), key=lambda f: f.cost).rest, observed)
    return log_bayes_factor(first, fit, observed, value) < CLOSE


def polished(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A fit repeated about itself until it leaves no less; a law that is not smooth takes some rounds."""
    best, there, idle = fit, about, 0
    for _ in range(ROUNDS):
        if idle == 2 or max(above_noise(best.rest, about.observed).values()) < QUIET:
            break
        about = about.about(fit)
        fit = about.fit(fit.members)
        idle = 0 if fit.cost < BETTER * best.cost else idle + 1
        if fit.cost < best.cost:
            best, there = fit, about
    return best, there


def settled(fit: Fit, about: Fitter) -> tuple[Fit, Fitter]:
    """A fit repeated about itself until C falls by less than one: until its values are those of the least C.

    What ends the search for names, a gap below the noise, leaves values that are off by several sigma where
    they act alike.
    """
    best, there = fit, about
    for _ in range(ROUNDS if fit.members else 0):
        about = about.about(fit)
        fit = about.fit(fit.members)
        if fit.cost > best.cost - SETTLED:
            return min((best, there), (fit, about), key=lambda pair: pair[0].cost)
        best, there = fit, about
    return best, there


def _backward(fitter: Fitter, best: Fit, null: Fit) -> tuple[Fit, Fitter]:
    """Drops what the others have made needless."""
    observed = fitter.observed
    k = 0
    while len(best.members) > 1 and k < len(best.members):
        rest = tuple(m for i, m in enumerate(best.members) if i != k)
        try:
            fewer = fitter.fit(rest)
        except (InvalidParameter, NotConverged, ValueError):
            k += 1
            continue
        if accepted(best, fewer, null, observed):
            k += 1
        else:
            best, fitter, k = fewer, fitter.about(fewer), 0
    return best, fitter


def _rivals(
    fitter: Fitter,
    probed: Sequence[Probed],
    best: Fit,
    null: Fit,
    k: int,
    tried: Sequence[Fit],
    value: Mapping[Channel, float],
) -> list[Rival]:
    """What could stand in the place of one effect, with ln Z behind the chosen model's.

    Beside a gap that the chosen model leaves open no name is certain: rivals are fewer and not polished
    there, and none is ahead that does not foretell clearly better.
    """
    observed = fitter.observed
    open_gap = leaves_gap(best, null, observed)
    others = tuple(m for i, m in enumerate(best.members) if i != k)
    mine = best.members[k].place
    rest = {m.place for m in others}
    known = {
        next(iter(set(f.places) - rest)): f
        for f in tried
        if rest < set(f.places) and len(f.members) == len(best.members)
    }
    without = fitter.fit(others)
    shares = [s for s in screen(fitter, probed, without) if s.members[0].place != mine]
    found = []
    most = PAIRS if open_gap else TRIED
    for share in sharpened(fitter, _one_variant(shares, 2 * most), without)[:most]:
        place = share.members[0].place
        about = fitter
        try:
            fit = known.get(place) or fitter.fit((share.members[0], *others))
            behind = log_bayes_factor(best, fit, observed, value)
            if behind < CLOSE:
                about = fitter.about(fit)
                fit = about.fit(fit.members)
                behind = log_bayes_factor(best, fit, observed, value)
            if behind < WITHIN_SIGHT and not open_gap:
                fit, _ = polished(fit, about)
                behind = log_bayes_factor(best, fit, observed, value)
        except (InvalidParameter, NotConverged, ValueError):
            continue
        member = next(m for m in fit.members if m.place == place)
        told = not open_gap or not foretells_better(best, fit, observed)
        if open_gap and not foretells_better(fit, best, observed):
            behind = max(behind, 0.0)
        found.append(Rival(member, fit, behind, log_likelihood_ratio(best, fit, observed, value), told))
    return sorted(found, key=lambda rival: rival.behind)


def probabilities(rivals: Sequence[Rival]) -> list[float]:
    """Of the chosen effect and its rivals, odds from their evidence."""
    odds = [1.0, *(exp(-min(max(rival.behind, -50.0), 700.0)) for rival in rivals)]
    return [each / sum(odds) for each in odds]
