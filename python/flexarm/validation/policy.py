"""Thresholds by which sensors, clocks, frames and drives are judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import log, pi

from flexarm.comparison.aligned_record import MOVING_RATE
from flexarm.comparison.drive_outliers import SpikePolicy


@dataclass(frozen=True)
class ValidationPolicy(SpikePolicy):
    """Hold the thresholds of `flexarm.validation`; a comment states the unit and the reason of each."""

    # evidence
    prior_log_odds: float = log(1e-3)  # [nats] log odds of a fault of a channel: one in a thousand
    clear_log_odds: float = 5.0  # [nats] a drive is at fault from this difference of costs on
    stuck_log_odds: float = 20.0  # [nats] log odds given to a drive that does not move
    max_log_odds: float = 1e3  # [nats] no larger log odds are told apart
    independent_samples: int = 20  # [-] most independent samples of a channel: ten swings to and fro
    min_sigmas: float = 5.0  # [sigma] a gain or a frame shift must be known to
    min_noises: float = 10.0  # [noise] a shift, a motion or a scatter above this is not noise
    unusual_ratio: float = 3.0  # [-] multiple of the usual value from which on something is unusual

    # model error of a nominal model
    missed_share: float = 0.03  # [-] share of the motion that it misses
    missed_ringing: float = (
        0.1  # [-] the same of torques, strains, bending, accelerations and rates, which ring
    )
    missed_at_rest: float = 1e-3  # [rad, reach] what it misses whatever the motion

    # nuisance regressors: prior deviations, far wider than any record states
    turn_std: float = 0.05  # [rad] lean of a frame, sensor or arm: three degrees
    delay_std: float = 0.03  # [s] delay of a clock, at least
    offset_std: Mapping[str, float] = field(
        default_factory=lambda: {
            **{"joint_angle": 0.1, "acceleration": 0.5},
            **dict.fromkeys(("inclination", "orientation", "angular_rate"), 0.05),
        }
    )  # [SI] offset of a sensor, by quantity; infinite of others
    frame_offset_std: float = 0.02  # [reach] offset of a frame, at least
    short_delay: float = 5e-3  # [s] half the difference of time for the rate of a prediction

    # gains
    gain_rounds: int = 8  # [-] most rounds of the estimate of a gain
    max_gain: float = 1.6  # [-] greatest gain, or its inverse, that a missing effect gives
    max_loaded_gain: float = 3.0  # [-] the same of quantities that bear loads
    max_load_gain: float = 20.0  # [-] gain that a load which is not stated may give to these
    max_unexplained: float = 0.3  # [-] greatest share of the motion that a hypothesis may leave
    negligible_share: float = 0.02  # [-] share of a motion, or of the rows, that is negligible
    max_penalty: float = 4.5  # [nats] nuisance regressors may take: an offset of three sigma
    max_delay: float = 0.15  # [s] delays that turn the sign of a vibration
    min_rows: int = 6  # [-] fewest readings of a channel that is judged

    # plateaus
    min_plateau_rows: int = 5  # [-] fewest rows of a plateau
    plateau_motion: float = 0.2  # [std] of the prediction within a plateau
    noisy_plateau_motion: float = 1.0  # [std] the same for a noisy plateau inside the range
    plateau_steps: float = 3.0  # [grid steps] the prediction moves within a plateau of counts
    lost_share: float = 0.1  # [-] share of lost rows that is reported, or makes a channel dead
    predominant_share: float = 0.8  # [-] share of plateaus at range ends, or squares a clock step explains

    # clocks and stamps
    min_clock_step: float = 3e-3  # [s] least step of a delay that is reported
    clock_step_times: int = 60  # [-] instants of such a step that are tried
    pause_ratio: float = 20.0  # [-] interval over the usual one that is a pause
    smooth_rate_hz: float = 50.0  # [Hz] angles are smooth from sample to sample from this rate on
    moving_rate: float = MOVING_RATE  # [-] share of its greatest rate above which a drive moves

    # frames
    min_shift: float = 5e-3  # [reach] least shift of a place
    min_shift_part: float = 0.05  # [-] share of a shift that an axis must have to be reported
    shift_agreement: float = 0.2  # [-] share of a shift to which the signals of a frame agree
    registration_steps: int = 10  # [-] most Gauss-Newton steps of a frame; turns of a radian take five
    undetermined: float = 0.02  # [-] singular value over the greatest: data do not determine that motion
    min_motion: float = 0.1  # [reach, distance from the base] least motion that shows a frame or drive

    # drives
    coarse_step: float = 1e-2  # [s] step of hypotheses: enough to tell a factor of 57 or a sign
    rigid_step: float = 0.02  # [s] between instants of the rigid arm: joints move little in that time
    rigid_instants: int = 2000  # [-] most of these instants
    rigid_rows: int = 400  # [-] most readings of a signal that are compared with the rigid arm
    min_repaired: float = 0.7  # [-] share of the channels that a hypothesis must leave in order
    factor_tolerance: float = 0.1  # [log] factors as near as that are the same to a motion
    factor_accuracy: float = 0.01  # [log] accuracy of a factor, to which it is told from a gear's ratio
    max_corrections: int = 3  # [-] most corrections of a factor: where it is off by much gains shrink
    implausible_angle: float = 20 * pi  # [rad] five times as far as hardly any joint goes
    min_drive_motion: float = 1e-3  # [rad, m] standard deviation that a hypothesis must leave a drive
    similar_factors: float = 12.0  # [-] ratio of factors within which one may pass for another
    min_standstill: float = 0.01  # [-] least share of a record at rest
    whole_standstill: float = 0.95  # [-] share of a record at rest from which on a drive never moves
    min_swing: float = 0.05  # [reach, rad] motion of a place or angle that only a moving drive makes

    # outliers
    vibration_period: float = 0.6  # [s] slower motions are no vibration
    vibration_step: float = 0.02  # [s] grid on which vibration is found

    @property
    def decisive_log_odds(self) -> float:
        """Return log odds from which on only hypotheses near the best one are tried [nats]."""
        return 3 * self.clear_log_odds


POLICY = ValidationPolicy()
