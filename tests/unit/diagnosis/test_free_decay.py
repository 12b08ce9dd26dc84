"""Frequency and damping of free vibrations against their amplitude, beside laws that can be solved."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexarm import Record, Signal
from flexarm.residual_analysis.free_decay import (
    DecaySegment,
    FreeDecay,
    _at_rest_since,
    decay_segments,
    describe_free_decays,
    fitted_segment,
    free_decays,
    weighted_mean,
)
from flexarm.residual_analysis.policy import POLICY
from flexarm.residual_analysis.residual_parts import ResidualPart, SignalResidual
from flexarm.residual_analysis.unexplained import unexplained_residual

RNG = np.random.default_rng(31)
OMEGA = 2 * np.pi * 2.2


def stamps(end, rate=200.0):
    """Jittery, with drop-outs."""
    time = np.arange(1 / rate, end - 1 / rate, 1 / rate)
    time = time + RNG.uniform(-0.2, 0.2, len(time)) / rate
    return time[RNG.random(len(time)) > 0.02]


def friction(time, amplitude, shift):
    """x of a spring with dry friction F = k shift, released at `amplitude`: half a cosine after the other.

    Between two turns x - s shift = B cos(omega t); B falls by 2 shift at each turn [Nayfeh1979].
    """
    half = np.floor(OMEGA * time / np.pi)
    left = np.maximum(amplitude - (2 * half + 1) * shift, 0.0)
    sense = np.where(half % 2 == 0, 1.0, -1.0)
    return left * np.cos(OMEGA * time) + sense * shift


def test_a_gap_of_free_vibration_is_told_at_its_instant_with_its_frequency():
    """No joint moves in a tap test: it was told as a pose."""
    time, zero = np.arange(0, 4, 1e-2), np.zeros(400)
    x, ones = np.sin(2 * np.pi * 5.0 * time), np.ones(400)
    parts = (
        ResidualPart("quasi-static", (0.0, 1.0), zero, ones, 8.0),
        ResidualPart("above", (1.0, 50.0), x, ones, 392.0),
    )
    rows = SignalResidual(
        "imu", "m/s2", ("tap",), zero.astype(int), time, {"x": x}, {"x": 0.1 * ones}, {"x": parts}, ()
    )
    constant = SimpleNamespace(best="constant", adjusted={}, constant=0.0)
    told = str(unexplained_residual(SimpleNamespace(gaps={"imu": rows}, dependence={"imu": constant})))
    assert "pose" not in told
    assert "s of tap" in told and "near 5 Hz" in told


def test_a_linear_law_has_one_frequency_and_one_damping():
    """Eq. (1) holds from end to end; noise of a hundredth of the first amplitude."""
    time, zeta = stamps(9.0), 0.02
    x = 0.3 + 0.01 * time + np.exp(-zeta * OMEGA * time) * np.cos(OMEGA * time + 0.7)
    pieces = list(decay_segments(time, x + 0.01 * RNG.normal(size=len(time))))
    assert len(pieces) >= 4
    for piece in pieces:
        assert abs(piece.frequency_hz - 2.2) < 4 * piece.frequency_std
        assert abs(piece.damping_ratio - zeta) < 4 * piece.damping_std
        assert piece.amplitude == pytest.approx(np.exp(-zeta * OMEGA * piece.time), rel=0.03)


def test_a_second_mode_beside_the_strongest_is_no_change_of_damping():
    """Both decay at constant rates; a third of the amplitude swings 2.7 times as fast."""
    time, zeta = stamps(9.0), 0.01
    x, y = (np.exp(-zeta * w * time) * np.cos(w * time + 0.7) for w in (OMEGA, 2.7 * OMEGA))
    pieces = tuple(decay_segments(time, x + y / 3 + 0.003 * RNG.normal(size=len(time))))
    assert len(pieces) >= 4
    for piece in pieces:
        assert piece.damping_ratio == pytest.approx(zeta, abs=1.5e-3)
    decay = FreeDecay("tap", "tip", "m", pieces)
    assert not (decay.damping_moves or decay.frequency_moves)


def test_stated_errors_are_those_of_repeated_measurements():
    """One sigma over 60 draws of the noise is known to 9 %."""
    time = stamps(POLICY.decay_periods / 2.2)
    x = np.exp(-0.03 * OMEGA * time) * np.cos(OMEGA * time)
    pieces = [fitted_segment(time, x + 0.02 * RNG.normal(size=len(time)), 2.0)[0] for _ in range(60)]
    for name in ("frequency", "damping"):
        values = [getattr(p, "frequency_hz" if name == "frequency" else "damping_ratio") for p in pieces]
        assert np.std(values) == pytest.approx(np.mean([getattr(p, f"{name}_std") for p in pieces]), rel=0.3)


def test_dry_friction_damps_more_the_smaller_the_swing():
    """Eq. (2): zeta A = 2 F/(pi k) throughout, at one frequency; 4 F/k are lost in a period."""
    shift = 0.004
    time = stamps(9.0, 300.0)
    pieces = list(decay_segments(time, friction(time, 0.5, shift)))
    assert pieces[-1].amplitude < 0.6 * pieces[0].amplitude
    for piece in pieces:
        assert piece.frequency_hz == pytest.approx(2.2, rel=2e-3)
        assert piece.damping_ratio * piece.amplitude == pytest.approx(2 * shift / np.pi, rel=0.05)


def test_a_spring_that_softens_swings_slower_the_larger_its_swing():
    """omega^2 = omega_0^2 (1 + 3 beta A^2/4) to first order [Nayfeh1979]; beta A^2 = -0.16 at first."""
    beta, zeta = -0.16, 0.01
    time = stamps(9.0)

    def law(_, y):
        return [y[1], -(OMEGA**2) * y[0] * (1 + beta * y[0] ** 2) - 2 * zeta * OMEGA * y[1]]

    x = solve_ivp(law, (0, 9.0), [1.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-9).y[0]
    pieces = list(decay_segments(time, x))
    assert pieces[0].frequency_hz < 0.97 * pieces[-1].frequency_hz
    for piece in pieces:
        wanted = 2.2 * np.sqrt(1 + 0.75 * beta * piece.amplitude**2)
        assert piece.frequency_hz == pytest.approx(wanted, rel=4e-3)


def test_noise_alone_has_no_pieces():
    time = stamps(20.0)
    assert len(list(decay_segments(time, RNG.normal(size=len(time))))) == 0
    assert list(decay_segments(time, np.zeros(len(time)))) == []


def test_pieces_are_averaged_by_what_they_know():
    """Weights 1/sigma^2: 4 to 1 for the damping, 1 to 4 for the frequency; sigma of the mean 1/sqrt(sum)."""
    found = weighted_mean(
        [DecaySegment(0.0, 1.0, 2.0, 0.01, 0.2, 0.001), DecaySegment(5.0, 0.5, 2.5, 0.02, 0.1, 0.002)]
    )
    assert (found.time, found.amplitude) == pytest.approx((1.0, 0.9))
    assert (found.frequency_hz, found.damping_ratio) == pytest.approx((2.4, 0.012))
    assert (found.frequency_std, found.damping_std) == pytest.approx((0.04**0.5 / 5**0.5, 0.002 / 5**0.5))


# ------------------------------------------------------------------------------------------------- records


def pair(x, until=2.0, late=0.0):
    """A record whose drive moves until an instant, and stands; stamps of the tip may be late."""
    time = np.arange(0.0, 12.0, 0.005)
    angle = np.minimum(time, until) * 0.2
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", side="motor", values=angle, time=time)
    shaken = np.where(time < until, 3.0 * np.sin(9 * time), x(np.maximum(time - until, 0.0)))
    values = np.stack([0.1 * shaken, shaken], axis=1)
    tip = Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), values=values, time=time + late
    )
    record = Record(signals=[hinge, tip], drive=("hinge",))
    simulated = SimpleNamespace(
        evidence={"tip": record.signals["tip"]}, instants=lambda signal, placement: signal.time - placement
    )
    return SimpleNamespace(record=record, simulated=simulated, aligned=SimpleNamespace(placement=late))


def test_a_record_rings_down_from_where_its_drive_stands():
    (found,) = free_decays({"run": pair(lambda t: np.exp(-0.02 * OMEGA * t) * np.cos(OMEGA * t))})
    assert (found.record, found.signal, found.unit) == ("run", "tip", "m")
    assert found.pieces[0].time == pytest.approx(2.0 + 1.5 / 2.2, abs=0.05)
    assert found.pieces[0].amplitude == pytest.approx(np.exp(-0.02 * 3 * np.pi), rel=0.01)  # the second axis
    assert not found.frequency_moves
    assert not found.damping_moves
    assert describe_free_decays([found]) == ""


def test_a_late_clock_takes_no_end_of_the_motion_for_vibration():
    """By its own stamps the tip still follows the drive for a second after that stands."""
    (found,) = free_decays({"run": pair(lambda t: np.exp(-0.02 * OMEGA * t) * np.cos(OMEGA * t), late=1.0)})
    assert found.pieces[0].time == pytest.approx(2.0 + 1.5 / 2.2, abs=0.05)
    assert not (found.frequency_moves or found.damping_moves)


def test_a_move_that_ends_gently_lasts_until_its_noise_hides_it():
    """A cube of the time left: 0.1 % of 0.4 rad is passed 0.2 s before the end, 5 sigma 0.03 s before."""
    gentle = pair(lambda t: np.exp(-0.02 * OMEGA * t) * np.cos(OMEGA * t))
    hinge = gentle.record.signals["hinge"]
    angle = 0.4 - 0.05 * np.maximum(2.0 - hinge.time, 0.0) ** 3
    found = {}
    for noise in (None, 2e-7):
        signals = {**gentle.record.signals, "hinge": hinge.replace(values=angle, noise_std=noise)}
        run = SimpleNamespace(**{**vars(gentle), "record": gentle.record.replace(signals=signals)})
        found[noise] = _at_rest_since(run)
    assert found[None] == pytest.approx(1.8, abs=0.01)
    assert found[2e-7] == pytest.approx(1.97, abs=0.01)


def test_what_moves_with_the_amplitude_is_said_in_a_sentence():
    (found,) = free_decays({"run": pair(lambda t: friction(t, 0.5, 0.004))})
    assert found.damping_moves
    assert not found.frequency_moves
    said = describe_free_decays([found])
    assert said.startswith(
        "While the drive stands, the damping moves with the amplitude, as of no linear law"
    )
    assert "tip of run: 2.20 Hz" in said


def test_a_drive_that_never_stands_leaves_nothing_to_look_at():
    assert free_decays({"run": pair(np.cos, until=12.0)}) == []
