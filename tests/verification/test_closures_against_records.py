"""Arms with closed loops beside records: derivatives, comparison, calibration and diagnosis of a crane."""

import loops
import numpy as np
import pytest
from loops import flexible_crane as crane

import flexarm
from flexarm import Arm, Record
from flexarm.arm.parameter import with_value
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.noise_model import with_fine_step
from flexarm.diagnosis.problem import Problem
from flexarm.validation.sensor_check import check

pytestmark = pytest.mark.slow

KEYS = (
    "payloads.load.mass",
    "links.boom.material.youngs_modulus",
    "effects.joint_compliance.piston.stiffness",
    "links.rod.mass",
)
PIN = {"name": "coulomb_friction", "at": "boom_pin", "torque": 800.0}
EYE = {"name": "coulomb_friction", "at": "rod_eye", "torque": 1500.0}
SOFT_PIN = {"name": "joint_radial_compliance", "at": "boom_pin", "stiffness": 1e7, "damping": 1e4}
OIL = {"name": "oil_column", "at": "piston", "bulk_modulus": 1.2e9, "piston_area": 5e-3, "ring_area": 2.5e-3}
OIL |= {"dead_volume": 3e-4, "stroke": 0.8, "damping": 2e4}
CUSHION = {"name": "end_cushion", "at": "piston", "low": 0.0, "high": 0.47, "stiffness": 1e8, "length": 0.06}
CUSHION |= {"damping": 2e5}
COMPLIANCE = {"name": "joint_compliance", "at": "piston", "stiffness": 4e6, "damping": 2e4}


def lift(rate: float = 1.5, end: float = 2.0) -> flexarm.Drive:
    """A stroke that begins and ends at rest."""
    t = np.linspace(0, end, 201)
    return flexarm.Drive.from_samples(
        t, {"piston": 0.4 + 0.1 * np.sin(np.pi * t / end) ** 2 * np.cos(rate * t)}
    )


def record(arm: Arm, rate: float, seed: int) -> Record:
    """Return a virtual record of steps that err by 0.5 micrometres; of 2 ms it would be 45, a gap."""
    return loops.crane_record(arm, lift(rate), 2.5e-4, seed)


def test_derivatives_of_an_equilibrium_are_those_of_differences():
    """Central differences of 0.1 % err by 1e-6."""
    arm = crane(effects=[COMPLIANCE])
    found = flexarm.static(arm, {"piston": 0.42}, sensitivities=KEYS)
    for name in ("position", "joint_torque", "link_angle"):
        for key, slope in zip(KEYS, np.moveaxis(found.sensitivities[name], -1, 0), strict=True):
            assert slope == pytest.approx(
                _difference(arm, key, name), rel=1e-5, abs=1e-5 * np.abs(slope).max()
            )


def _difference(arm: Arm, key: str, name: str) -> np.ndarray:
    value = next(p.value for p in flexarm.static(arm, {}, sensitivities=[key]).sensitivities.parameters)
    h = 1e-3 * value
    up, down = (flexarm.static(with_value(arm, key, value + e), {"piston": 0.42}) for e in (h, -h))
    return (getattr(up, name) - getattr(down, name)) / (2 * h)


def test_derivatives_beside_redundant_conditions_are_those_of_differences():
    """Of a rigid crane, whose closure repeats three conditions; differences of 0.1 % are exact."""
    key, redundant = "payloads.load.mass", loops.crane()
    found = flexarm.static(redundant, {"piston": 0.42}, sensitivities=[key])
    up, down = (flexarm.static(with_value(redundant, key, m), {"piston": 0.42}) for m in (500.5, 499.5))
    force = found.sensitivities["joint_torque"][..., 0]
    assert force == pytest.approx(up.joint_torque - down.joint_torque, rel=1e-6, abs=1e-6)
    assert np.abs(force).max() > 9.81  # N/kg: the lever of the load is longer than the cylinder's


def test_a_record_of_a_crane_is_checked_without_faults():
    assert check(crane(), {"slow": record(crane(), 1.5, 3)}).faults == ()


def test_derivatives_of_frequencies_are_those_of_differences():
    """Central differences of 0.01 % err by 1e-6."""
    arm = crane(effects=[COMPLIANCE])
    found = flexarm.modes(arm, {"piston": 0.42}, count=4, sensitivities=KEYS)
    for k, parameter in enumerate(found.sensitivities.parameters):
        h = 1e-4 * parameter.value
        up, down = (
            flexarm.modes(with_value(arm, parameter.key, parameter.value + e), {"piston": 0.42}, count=4)
            for e in (h, -h)
        )
        difference = (up.frequency_hz - down.frequency_hz) / (2 * h)
        slope = found.sensitivities["frequency"][..., k]
        assert slope == pytest.approx(difference, rel=1e-4, abs=1e-4 * np.abs(difference).max()), (
            parameter.key
        )


def test_derivatives_of_a_motion_are_those_of_differences():
    """Within 5e-3: differences err by their size and by Newton's tolerance of the plain runs."""
    arm = crane(effects=[COMPLIANCE])
    found = flexarm.simulate(arm, lift(), step=5e-3, sensitivities=KEYS)
    for k, parameter in enumerate(found.sensitivities.parameters):
        h = 3e-4 * parameter.value
        up, down = (
            flexarm.simulate(with_value(arm, parameter.key, parameter.value + e), lift(), step=5e-3)
            for e in (h, -h)
        )
        for name in ("position", "joint_torque", "joint_angle"):
            slope = found.sensitivities[name][..., k]
            difference = (getattr(up, name) - getattr(down, name)) / (2 * h)
            assert np.abs(slope - difference).max() < 5e-3 * np.abs(difference).max(), (parameter.key, name)


def test_a_crane_is_compared_with_its_record():
    """Of the same model noise is left, and what it does to the drive; a load 20 kg heavier is seen."""
    same, heavier = (
        flexarm.compare(crane(), record(arm, 1.5, 1), step=5e-4).signals["tip"].rms["total"]
        for arm in (crane(), crane(payloads=[{**crane().to_dict()["payloads"][0], "mass": 520.0}]))
    )
    assert same < 1.5 * 2e-5 * 3**0.5
    assert heavier > 3 * same


def test_a_soft_cylinder_is_calibrated():
    """From twice its stiffness to the true one, within the stated interval's triple."""
    truth = record(crane(effects=[COMPLIANCE]), 1.5, 2)
    key = "effects.joint_compliance.piston.stiffness"
    start = crane(effects=[{**COMPLIANCE, "stiffness": 8e6}], uncertainty={key: 0.9})
    found = flexarm.calibrate(start, {"lift": truth})
    assert found.updated.effects[0].stiffness == pytest.approx(4e6, rel=0.01)


def softer(modulus: float) -> Arm:
    """The crane with a boom of another modulus [Pa]."""
    boom, *others = crane().to_dict()["links"]
    return crane(links=[{**boom, "material": {**boom["material"], "youngs_modulus": modulus}}, *others])


def loaded(mass: float) -> Arm:
    """The crane with another load [kg]."""
    return crane(payloads=[{**crane().to_dict()["payloads"][0], "mass": mass}])


def test_the_true_model_leaves_white_noise():
    """Mean square over the noise, with the drive's noise smoothed and time steps corrected.

    It is 1 within five standard deviations of chi-square; neighbouring residuals are not correlated.
    """
    problem = Problem(crane(), {"slow": record(crane(), 1.5, 3)}, step=2e-3)
    left = problem.residual(crane()) + problem.correction(crane())
    for _, where in problem.channels():
        each, n = left[where], where.stop - where.start
        assert np.mean(each**2) == pytest.approx(1.0, abs=5 * (2 / n) ** 0.5)
        assert abs(np.sum(each[1:] * each[:-1])) / np.sum(each**2) < 3 / n**0.5


def test_a_search_takes_a_step_that_its_correction_can_make_good():
    """Twice 2 ms move the tip by 6 times its noise where they are halved, half of them by 1.7 times."""
    problem = Problem(crane(), {"slow": record(crane(), 1.5, 3)}, step=4e-3)
    assert with_fine_step(problem, crane()).step == 2e-3
    coarse = problem.with_noise(np.full(len(problem.rows), 10.0))
    assert with_fine_step(coarse, crane()).step == 4e-3


def diagnosed(truth: Arm, seed: int) -> flexarm.Diagnosis:
    """Diagnose the crane from a slow and a held-out quicker motion of another one."""
    records = {"slow": record(truth, 1.5, seed)}
    return flexarm.diagnose(crane(), records, hold_out=record(truth, 3.0, seed + 100))


@pytest.mark.parametrize("seed", [3, 13])
def test_a_crane_in_which_nothing_is_hidden_is_adequate(seed):
    found = diagnosed(crane(), seed)
    assert (found.verdict, found.effects) == ("adequate", ())


@pytest.mark.parametrize(
    ("truth", "name", "place"),
    [
        (crane(effects=[COMPLIANCE]), "joint_compliance", "piston"),
        (crane(effects=[PIN]), "coulomb_friction", "boom_pin"),
        (crane(effects=[EYE]), "coulomb_friction", "rod_eye"),
        (crane(effects=[SOFT_PIN]), "joint_radial_compliance", "boom_pin"),
        (softer(200e9), "link_stiffness", "boom"),
        (loaded(520.0), "payload_mass", "load"),
    ],
)
def test_what_a_crane_hides_is_named_or_among_what_the_data_cannot_part_from_it(truth, name, place):
    """A softer boom sags and swings as one with more load does; a measured force would part them."""
    found = diagnosed(truth, 3)
    assert found.verdict == "effects"
    [effect] = found.effects
    assert (name, place) in [
        (effect.name, effect.at),
        *((each.name, each.at) for each in effect.alternatives),
    ]


@pytest.mark.parametrize(
    ("stated", "key", "true"),
    [(OIL, "bulk_modulus", 5e8), (CUSHION, "damping", 4e4)],
    ids=["air in the oil", "worn throttle"],
)
def test_a_cylinder_that_is_not_as_stated_is_named(stated, key, true):
    """The model states oil and cushion, of which the machine has one otherwise."""
    model = crane(effects=[OIL, CUSHION])
    effects = [{**each, key: true} if each is stated else each for each in (OIL, CUSHION)]
    truth = crane(effects=effects)
    found = flexarm.diagnose(model, {"slow": record(truth, 1.5, 3)}, hold_out=record(truth, 3.0, 103))
    [effect] = found.effects
    assert (found.verdict, effect.name, effect.at) == ("effects", stated["name"], "piston")
    [size] = [each for each in effect.parameters if each.name == key]
    assert size.value == pytest.approx(true, abs=3 * size.std)
    assert size.std < 0.1 * true


def test_oil_and_cushions_are_sought_where_the_model_states_them():
    """At other joints a compliance stands for oil; ends that nobody states are anywhere."""
    sought = [
        {(c.name, c.at) for c in candidates(Problem(arm, {"slow": record(crane(), 1.5, 3)}), arm)}
        for arm in (crane(), crane(effects=[OIL, CUSHION]))
    ]
    assert sought[1] - sought[0] == {("oil_column", "piston"), ("end_cushion", "piston")}
