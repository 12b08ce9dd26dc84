"""Thresholds of the search for effects, and settings of fits, noise models and planned experiments.

`flexarm.diagnose(..., policy=SelectionPolicy(reach=4.0))` changes some of them; `benchmarks/ablation.py`
shows for each one which answers hang on it. Settings are not for users to choose.
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


@dataclass(frozen=True)
class FitSettings:
    """Numerical settings of fits: steps of differences, iterations, tolerances."""

    prior_weight: float = 1 / 3
    """Weight [-] of priors in fits: they need not know this machine."""
    least_factor: float = 30.0
    """Least range of a logarithmic parameter, as a factor [-]: a mass may be many sigmas off."""
    smooth_step: float = 3e-4
    """Step of differences [sigma]: 0.01 shifts a vibration of a minute by tenths of a radian."""
    non_smooth_step: float = 1e-2
    """The same for non-smooth laws [sigma]: across their corners."""
    phase_step: float = 0.01
    """Greatest phase that the step of a frequency adds until the end of a record [rad]."""
    relative_step: float = 3e-4
    """Part of a parameter [-], for differences of runs: Newton's iterations end 1e-7 m apart."""
    point_step: float = 1e-4
    """Shift of a point [m], for a difference that is exact to rounding."""
    ripple_step: float = 0.3
    """Differences of nominal values in non-smooth models [sigma]: across ripples."""
    widest_step: float = 0.02
    """The same at most, as part of the value [-]."""
    greatest_loss: float = 0.8
    """Greatest part [-] that a nominal value may lose: linear steps may be too long."""
    small_probe: float = 1e-3
    """Part of a probe [-] that is a small step; 0.03 is too nonlinear for the spring of a rigid joint."""
    evaluations: int = 8
    """Most evaluations of a fit besides differences [1]."""
    tolerance: float = 2e-3
    """Relative tolerance of the steps of a fit [-]; of its cost a tenth of it."""
    step_missed: float = 0.25
    """Part of a step's effect [-] that Broyden's update may miss before differences are computed."""
    reused_within: float = 1.0
    """Distance of a parameter [sigma] within which derivatives of another model are reused."""
    further_fall: float = 2.0
    """Multiple [-] of the last or the predicted fall of the cost that a fit may still fall."""
    centred_within: float = 2.0
    """Sigmas within which nominal values are centred."""
    centring_rounds: int = 10
    """Most rounds of centring nominal values [1]."""
    better_share: float = 0.98
    """Part of a cost left [-] below which another round is made."""
    same_error: float = 0.1
    """Rms change of a residual [noise] within which its discretisation error is kept."""
    move_missed: float = 0.1
    """Part of a move [-] that nuisance derivatives may miss while they are kept."""
    step_ratio: float = 2.0
    """Time steps of fits over those of the diagnosis [-]; the discretisation error is corrected."""
    undetermined: float = 1e-15
    """Part of the greatest eigenvalue [-] below which a direction is undetermined: rounding."""
    undetermined_after: float = 1e-10
    """The same after rows were subtracted [-]: their rounding stays."""
    undetermined_weighted: float = 1e-12
    """The same of weighted rows [-]: directions that they hardly determine keep their values."""
    spread_rounds: int = 5
    """Steps of expectation maximisation [1]; each moves a spread half as far as the one before."""
    search_steps: tuple[float, ...] = (0.1, 0.03, 0.01, 0.003)
    """Hooke-Jeeves steps as parts of a parameter [-]."""
    search_ahead: int = 3
    """Hooke-Jeeves steps tried to each side [1]."""
    search_moves: int = 4
    """Most Hooke-Jeeves moves of one size [1]."""
    converging_steps: int = 6
    """Most steps until a fit converges [1]."""
    idle_rounds: int = 2
    """Rounds without progress after which a refinement ends [1]."""
    quiet: float = 0.4
    """Residual above the noise, over the noise [-], at which a refinement ends."""
    least_fall: float = 1.0
    """Least fall of the cost in a round of refinement [squared sigmas of the residual]."""
    converged_fall: float = 0.1
    """Fall of the cost in a step below which a fit has converged [squared sigmas of the residual]."""
    backtracking: tuple[float, ...] = (1.0, 0.3, 0.1)
    """Parts of a step that are tried in turn [-]."""
    null_rounds: int = 2
    """Rounds in which the model without effects is relinearised [1]."""
    relinearised: int = 3
    """Most times that a fit in conflict with priors is relinearised [1]."""
    least_gain: float = 0.3
    """Least gain of ln Z for another step of an alternative [-]: a tenth of what decides."""


@dataclass(frozen=True)
class NoiseSettings:
    """Settings of noise, model discrepancy and initial vibrations."""

    transient: int = 64
    """Samples [1] after which the gain of the Kalman filter is constant."""
    pause: float = 3.0
    """Interval over the usual one [-] that is a pause of a record."""
    pose_lengths: tuple[float, ...] = (0.1, 0.2, 0.5)
    """Correlation lengths of poses, over the spread of their angles [-]."""
    longest: float = 0.1
    """Greatest correlation length in time, as part of the record [-]: longer is an effect."""
    bins: int = 80
    """Bands of frequency in which a periodogram is summed [1]: its density is smooth."""
    lags: int = 12
    """Samples [1] of the autocovariance that tells a residual from noise."""
    draws: int = 4
    """Draws of input noise [1]: a mode responds within its bandwidth, which is few values."""
    error_draws: int = 8
    """The same for intervals [1]: their width is then known to a quarter."""
    negligible: float = 0.3
    """Least error of some channel, over its noise [-], that counts: smaller ones add 4 %."""
    reported: float = 0.5
    """Least error, over the noise [-], that is reported."""
    dominant: float = 5.0
    """Error, over the noise [-], beyond which it replaces the noise of a channel."""
    halvings: int = 2
    """Most halvings of the time step [1]: a search then takes four times as long."""
    second_order: float = 4.0
    """Least fall of the error in a halving [-], of 16 at second order: below, it does not pay."""
    repeats: int = 6
    """Least repeated rows of poses [1] that show the noise: of two channels to a fifth."""
    rounding: float = 1e-12
    """Scatter over the greatest reading [-] that is rounding."""
    coarse_count: float = 5.0
    """Counts of an encoder over its stated noise [-] that the noise does not cover."""
    quantisation_factor: float = 2.0
    """Factor of a quantisation error [-], as one motion hardly predicts that of another."""
    start_modes: int = 3
    """Lowest modes that may vibrate when a record begins [1]."""
    jerk: float = 0.01
    """1 sigma of a jerk before a record [rad, m]: decimetres at the tip of a long arm."""
    jerk_step: float = 1e-4
    """Jerk of differences [rad, m]."""
    jerk_finer: int = 3
    """Time steps of fits over those of jerks [1]: free vibrations must stay in phase."""
    jerk_seen: float = 3.0
    """Least independent response to a jerk of one sigma, over the noise [-]."""
    jerk_own: float = 0.03
    """The same over the greatest response [-]."""


@dataclass(frozen=True)
class DesignSettings:
    """Assumptions about experiments that have not been made."""

    lighter: float = 0.35
    """The other payload, over that of the run [-]."""
    turn: float = 0.5
    """Distance of another pose [rad]; a tenth of it in m for a prismatic joint."""
    lever: float = 0.25
    """Distance of a reflector at a hub from the axis of its link [m]."""
    glued: float = 1e-3
    """1 sigma of the place of an added reflector [m]."""
    torque_noise: float = 0.01
    """Noise of a logged torque over its greatest value in the run [-]."""
    settled: float = 0.05
    """Part of the run [-] after which a logged torque counts: drives may start with a jump."""
    near: float = 0.2
    """Distance over the length of the link [-] within which a reflector exists already."""
    drive_hz: float = 250.0
    """Samples of a drive [Hz]."""
    tracker_hz: float = 10.0
    """Rate of an assumed tracker [Hz]."""
    prior_sigma: float = 3.0
    """Sigma [-] of the parameters of an alternative, as `FitSettings.prior_weight` has it."""
    enough: float = 10.0
    """Expected ln B [-] from which the cheapest addition is proposed."""
    alternatives: int = 3
    """Most alternatives that are simulated [1]."""
    far: float = 10.0
    """Multiple of the plausible size [-] beyond which no size is stated: laws are nonlinear."""
    nothing: float = 1e-3
    """Expected ln B [-] below which an effect leaves no trace in the signals."""


FIT = FitSettings()
NOISE_MODEL = NoiseSettings()
DESIGN = DesignSettings()
