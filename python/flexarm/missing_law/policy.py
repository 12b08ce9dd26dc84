"""Settings of the inference of a missing law."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LawPolicy:
    """Settings of the inference of a missing law, all with a default."""

    spacing: float = 0.1
    """Distance of knots in time [s]: a sudden change takes about two of them."""
    most_knots: int = 300
    """Greatest number of knots a record [1]: each costs a column of all derivatives."""
    lengths: tuple[float, ...] = (0.3, 1.0, 3.0, 10.0)
    """Correlation lengths of a latent motion [s]: from one knot to a third of a record."""
    response_step: float = 0.016
    """Time step of linear responses [s]: a mode of 3 Hz is 0.8 % slow, and the residual itself is exact."""
    perturbation: float = 1e-3
    """Perturbation of poses for a difference quotient [rad, m], above where Newton's iterations stop."""
    batch: int = 64
    """Splines that one run differentiates [1]; between runs the budget of time is checked."""
    most_joints: int = 3
    """Joints whose latent motion is inferred [1]: the best ones of a linear pass over all."""
    pass_spacing: float = 0.4
    """Distance of knots in time in that pass [s]: a quarter of the splines, without another linearisation."""
    linearisations: int = 2
    """Times that the residual is simulated about the latent motion [1]."""
    curve_knots: int = 41
    """Knots of a curve over its state [1]: a peak a tenth of the range wide has four."""
    knot_density: float = 2.5
    """Density a of knots at zero of rate or torque [-]: at the ends they are cosh a as far apart."""
    curve_lengths: tuple[float, ...] = (0.1, 0.3, 1.0, 3.0)
    """Correlation lengths of a curve over the range of its state [-]."""
    least_range: float = 1e-6
    """Range of a state over the greatest value of its kind in the arm [-] below which it is rounding."""
    samples: int = 8
    """States for each interval of knots in time [1]: what changes its sign does so at an instant."""
    blocks: int = 8
    """Blocks a record of cross-validation [1]: longer than what a smooth latent motion bridges."""
    instants: int = 40
    """Instants a record at which a law may change [1]."""
    finer: int = 10
    """Instants between two of these, about the most likely one [1]: its interval is found among them."""
    evidence: float = 6.0
    """Difference of log evidence that decides [-]: odds of 400."""
    least_share: float = 0.5
    """Part of what the latent motion explains [-] that a law explains."""
    clear_share: float = 0.9
    """The same [-] from which a curve is reported though a motion in time predicts the data better."""
    memory_share: float = 0.02
    """The same [-] that two branches, or an instant, explain beyond one curve."""
    shape_error: float = 0.1
    """Rms difference from a known shape over the peak [-] up to which a curve has that shape."""
    shape_scatter: float = 0.02
    """Error of knots over the peak [-] beside their covariance: real curves have no exact shape."""
    size_range: float = 1e12
    """Ratio of greatest and least prior variance of the grid [-]: from no motion to any."""
    sizes: int = 61
    """Prior variances of the grid [1]: a factor of 1.6 apart."""
    noises: int = 25
    """Noise variances of the grid [1], from the sensors' own to that of the whole residual."""
    least_turns: float = 2.0
    """Turns of a motor [1] from which its angle within a turn is a state: to tell it from the joint's."""
    turn_step: float = 0.125
    """Greatest part of a turn between samples [1]: eight samples show a sine."""
    most_laws: int = 4
    """Laws that are reported [1]."""
    line_prior: float = 3.0
    """Prior deviation of a straight part of a curve over the size of the rest [-]: wide."""
    refits: int = 4
    """Most Gauss-Newton steps of the knots of a law through the simulation [1]."""
    convergence: float = 1.0
    """Squared change of the residual over its noise [-] of a converged step: no value moves by a sigma."""
    law_step: float = 0.05
    """Perturbation of a law for a difference quotient over its peak [-]: larger than its wiggles."""
    least_mode: float = 1e-3
    """Size of the least mode of a curve that is fitted, over that of the greatest one [-]."""
    adequate_noise: float = 1.5
    """Residual variance over that of the noise [-] up to which one curve is adequate."""
    least_closed: float = 0.1
    """Least part of the held-out gap [-] that a law of the updated model removes: more than noise does."""
    window: float = 0.2
    """Window of the states that a law without a table acts along [s]: half a period of the first mode."""
    rounds: int = 3
    """Fixed-point iterations of such a law and its states [1]."""
