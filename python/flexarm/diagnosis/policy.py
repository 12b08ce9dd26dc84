"""Thresholds of the search for effects: what is accepted, tried, stopped and told.

`flexarm.diagnose(..., policy=SelectionPolicy(reach=4.0))` changes some of them; `benchmarks/ablation.py`
shows for each one which answers hang on it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf, log

from flexarm.arguments import NAMES, require
from flexarm.errors import InvalidParameter
from flexarm.former_names import takes_former_names

MOVES = (
    "confounding",
    "rescreening",
    "low_pass",
    "second_rank",
    "prior_ends",
    "gap_scan",
    "families",
    "twin_spring",
    "pairs",
    "triples",
    "spring_swap",
    "shapes",
    "model_errors",
    "backward",
    "swap",
)
"""Steps of the search that `SelectionPolicy.moves` may leave out; single proposals are always fitted."""


@dataclass(frozen=True)
class FamilyPolicy:
    """Prior of the spread of a family."""

    family_spread: float = 1.0
    """Prior spread [-] of ln(size) in a family: a factor e, as base and wrist of an arm differ."""
    family_count: float = 2.0
    """Members that the prior of a spread counts as [1]: it decides only where a family is small."""


@takes_former_names(
    renamed={"most_of_gap": "halfway"},
    removed={
        "families": "half as many families as `proposals` are fitted in a step",
        "rounds": "a search ends where nothing changes, at the latest after `most_effects` rounds",
        "family_places": "a family has at least three places, as two are a pair of effects",
        "doubtful": "a name in doubt has a probability of one half at most",
    },
)
@dataclass(frozen=True)
class SelectionPolicy(FamilyPolicy):
    """Thresholds of the search, all with a default.

    Evidence is ln B, a difference of log evidence [-]; pulls are in prior standard deviations [sigma].
    """

    # Acceptance
    strong_evidence: float = 6.0
    """ln B for an effect: odds of 400, for some forty effects at some places."""
    relief_evidence: float = log(5.0)
    """ln B for an effect that resolves a prior-data conflict: few effects do, and 3 sigma are rare."""
    reach: float = log(20.0)
    """ln B within which effects are indistinguishable."""
    predictive_evidence: float = log(200.0)
    """ln B of cross-validation: clearly better, whatever the correlation of the residual."""
    predictive_share: float = 0.2
    """Part [-] of the cross-validated residual that a clearly better, or a useful, model removes."""
    significant_noise: float = 0.5
    """Part explained in some channel, over the noise [-]: below, it cannot be seen in a plot."""
    significant_share: float = 0.05
    """The same over the gap without effects [-]: below, it does not matter to a user."""
    pull: float = 2.0
    """Pull [sigma] of a nuisance parameter that is no conflict: one in twenty is beyond."""
    conflict: float = 1.0
    """Sum of pulls beyond `pull` [sigma] that is a prior-data conflict: one parameter at 3 sigma."""
    least_reduction: float = 0.03
    """Part of C [-] that an effect removes where a gap stays: less is chance or imitation."""
    adequate_noise: float = 1.0
    """Residual above the noise, over the noise [-], that an adequate model may leave."""
    adequate_share: float = 0.07
    """The same over the gap without effects [-]: no model is exact."""
    negligible_share: float = 0.01
    """Part of a gap [-] that is nothing: not worth a fit, and all that an implausible size may leave."""

    # Evidence
    discrepancy: float = 0.2
    """Error of any simulation, over the noise [-]; lasting, so that length of a record adds nothing."""
    chance: float = 1e-3
    """p [-] below which a test rejects: few poses as noise, a parameter as homogeneous."""
    blocks: int = 24
    """Blocks a record [1] of cross-validation: shorter than a motion, longer than correlations."""

    # Nuisance parameters
    zero: float = 5e-3
    """1 sigma [rad, m] of the zero of an encoder or inclinometer that is evidence: 0.3 degrees."""

    # Stopping
    most_effects: int = 12
    """Effects, families counted once, swaps and rounds of a search [1]: a budget, as each takes fits."""
    hardly_helps: float = 0.15
    """Part of gap and conflict [-] that a first effect explains for a second; blind cases: 0.31 or more."""
    model_errors: float = 4.0
    """Mean square over the noise [-] below which input noise and time steps may be all of the gap."""

    # Proposals
    moves: tuple[str, ...] = MOVES
    """Steps of the search, of `MOVES`."""
    proposals: int = 6
    """Candidates fitted in a step [1], half as many sets or families: screening is right in its first few."""
    more_proposals: int = 4
    """Candidates fitted more [1], screened at low frequency or in conflict with priors."""
    among: int = 16
    """Places of which all triples are screened [1], and half as many from pairs: time grows as the cube."""
    family_leave: float = 1.0
    """ln B by which a family must be better without a place: places that no data show gain some 0.2."""
    faint: float = 0.3
    """Share of the best candidate's [-] below which others are not fitted once one explains all."""
    halfway: float = 0.5
    """Half of a gap [-]: what a fit must explain of the best one's part to be finished, two effects of all
    for a third to be sought, and a model that leaves a gap of the cross-validated residual to be kept."""
    alike: float = 0.1
    """Relative difference [-] that is none: of two costs, or of a parameter between records."""
    low_pass: float = 1.0
    """Window of the moving average [s]: some periods of a heavy arm, a small part of its motion."""
    confounded: float = 0.8
    """R2 [-] with what a nuisance parameter in conflict moves, for an effect to replace it."""

    # Refinement
    close: float = 30.0
    """ln B behind the best within which a model is fitted about itself: derivatives shift it so far."""
    within_sight: float = 8.0
    """ln B behind within which an alternative is refined until it rests: `reach` and what a step gains."""

    # Answers
    most_certain: float = 0.98
    """Greatest probability of a name [-]: some mechanism is in no vocabulary."""
    outlier: float = 6.0
    """Distance of a masked outlier from its neighbours' median [sigma]: one row of noise in 1e7."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value, whole = getattr(self, field.name), isinstance(field.default, int)
            kind = int if whole else int | float
            if field.name != "moves" and not (isinstance(value, kind) and 0 < value < inf):
                allowed = "a positive whole number" if whole else "a positive, finite number"
                raise InvalidParameter(f"must be {allowed}, got {value!r}", where=field.name)
        require(NAMES, "moves", self.moves)
        for move in self.moves:
            if move not in MOVES:
                raise InvalidParameter(f"must be of {', '.join(MOVES)}, got {move!r}", where="moves")

    def allows(self, move: str) -> bool:
        """Return True if a step of the search is on."""
        return move in self.moves
