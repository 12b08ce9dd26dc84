"""What no machine has is doubted, and no error: millimetres for metres, grams for kilograms, per cent."""

from pathlib import Path

import pytest
from arms import LENGTH, TUBE, beam, crane
from arms import arm as arm_of

import flexarm
from flexarm.arm.sizes import HEAVIEST, LONGEST, size_problems
from flexarm.cli.run import run

STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850}


def crane_with(
    end=LENGTH,
    material=STEEL,
    mass=14.1,
    section=TUBE,
    inertia=(0, 0, 0),
    rpy=(0, 0, 0),
    sensor=(),
    **changes,
):
    """The crane with another link, payload, frame, sensor or uncertainty."""
    joints = [{**crane().to_dict()["joints"][0], "origin": {"rpy": list(rpy)}}]
    rod = beam("rod", [0, 0, end], section, material=material)
    payload = {"name": "load", "link": "rod", "position": [0, 0, end], "mass": mass, "inertia": list(inertia)}
    points = [{"name": "tip", "link": "rod", "position": [0, 0, end]}]
    tip = {"name": "tip", "quantity": "position", "point": "tip", "rate_hz": 10.0, "noise_std": 5e-5}
    return arm_of(
        joints=joints,
        links=[rod],
        payloads=[payload],
        points=points,
        sensors=[{**tip, **dict(sensor)}],
        **changes,
    )


def doubted(arm):
    return [problem.where for problem in size_problems(arm)]


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"end": 2600.0}, "links.rod.end"),
        ({"end": 60.0}, "links.rod"),  # mm of a small arm, and a tube of 6 cm: it would hang down
        ({"material": {**STEEL, "youngs_modulus": 210e9 * 1e3}}, "links.rod.material.youngs_modulus"),
        ({"material": {**STEEL, "density": 7.85e6}}, "links.rod.material.density"),
        ({"mass": 14100.0}, "payloads.load.mass"),
        ({"uncertainty": {"payloads.load.mass": 2.0}}, "uncertainty.payloads.load.mass"),
        ({"uncertainty": {"points.tip.position_m": 10.0}}, "uncertainty.points.tip.position_m"),
        ({"inertia": [2e5, 2e5, 1e5]}, "payloads.load.inertia"),  # kg mm2
        ({"rpy": [0, 90, 0]}, "joints.hinge.origin.rpy"),
        ({"sensor": {"noise_std": 4.0}}, "sensors.tip.noise_std"),
        ({"sensor": {"noise_std": 4000.0, "unit": "mm"}}, "sensors.tip.noise_std"),
        ({"sensor": {"rate_hz": 1e6}}, "sensors.tip.rate_hz"),
        ({"sensor": {"jitter_std": 2.0}}, "sensors.tip.jitter_std"),
        ({"sensor": {"latency_s": 20.0}}, "sensors.tip.latency_s"),
    ],
)
def test_a_size_of_no_machine_is_doubted_at_its_place(changes, where):
    assert where in doubted(crane_with(**changes))


@pytest.mark.parametrize(
    ("rotor", "seconds", "where"),
    [
        (1e-3, 2e-3, []),
        (10.0, 2e-3, ["joints.hinge.rotor_inertia"]),  # kg cm2
        (1e-3, 2.0, ["controllers.hinge.sample_time"]),  # ms
    ],
)
def test_rotors_and_sample_times_in_other_units_are_doubted(rotor, seconds, where):
    """120^2 x 10 kg m2 are 500 times 40 kg at 2.6 m; K_p T = 4 x 2 is beyond the 2 of a stable loop."""
    arm = crane_with(gravity=(0, 0, -9.81))
    joint = arm.joints[0].replace(gear_ratio=120.0, rotor_inertia=rotor)
    loop = {"joint": "hinge", "type": "cascade", "position_gain": 4, "velocity_gain": 1e4}
    tables = {**arm.replace(joints=(joint,)).to_dict(), "controllers": [{**loop, "sample_time": seconds}]}
    assert doubted(flexarm.Arm.from_dict(tables)) == where


def test_sizes_that_machines_have_are_not_doubted():
    """The paper's arm; a metre of ruler on edge; the Space Station's arm in orbit; values hardly known."""
    assert doubted(crane_with(uncertainty={"payloads.load.mass": 1.0, "points.tip.position_m": 1.0})) == []
    ruler = {"shape": "rectangle", "width": 1e-3, "height": 0.03}
    upright = beam("rod", [1.0, 0, 0], ruler, material=STEEL, up=[0, 0, 1])
    assert doubted(arm_of(joints=crane().to_dict()["joints"], links=[upright])) == []
    boom = {"shape": "tube", "outer_diameter": 0.35, "thickness": 0.01}
    assert doubted(crane_with(end=17.6, mass=116e3, section=boom, gravity=[0, 0, 0])) == []
    assert doubted(crane_with(inertia=[8.0, 8.0, 1.0], rpy=[0, 3.14, -1.57])) == []  # a rod of 2.6 m across
    rough = {"noise_std": 20.0, "unit": "mm", "rate_hz": 2e4, "jitter_std": 2e-5, "latency_s": 0.5}
    assert doubted(crane_with(sensor=rough)) == []


def test_the_sag_is_that_of_a_cantilever():
    """A strip that hangs down by 1.01 times its length in linear theory is doubted, by 0.99 times not."""
    flat = {"shape": "rectangle", "width": 0.05, "height": 0.05}
    stiffness, weight = 210e9 * 0.05**4 / 12, 9.81 * 7850 * 0.05**2
    length = (8 * stiffness / weight) ** (1 / 3)
    assert length < LONGEST
    for times, doubt in ((0.99, []), (1.01, ["links.rod"])):
        link = beam("rod", [times ** (1 / 3) * length, 0, 0], flat, material=STEEL, up=[0, 0, 1])
        assert (
            doubted(arm_of(joints=crane().to_dict()["joints"], links=[link], gravity=[0, 0, -9.81])) == doubt
        )


def test_no_model_that_is_shipped_or_measured_is_doubted(shared_dir: Path, request):
    root = request.config.rootpath
    models = [*root.glob("examples/*.toml"), *shared_dir.glob("cases/case_*/model.toml")]
    assert len(models) >= 20
    for model in models:
        assert doubted(flexarm.Arm.from_toml(model)) == [], model


def test_a_check_warns_and_ends_with_zero(tmp_path, capsys):
    crane_with(end=2600.0, uncertainty={"payloads.load.mass": 2.0}).to_toml(tmp_path / "arm.toml")
    assert run(["check", str(tmp_path / "arm.toml")]) == 0
    err = capsys.readouterr().err
    assert f"warning: {tmp_path / 'arm.toml'}: links.rod.end: is 2600 m away" in err
    assert "is 200 % of the value (1 sigma)" in err


def test_the_limits_stay_beyond_what_is_built():
    """Booms of some 100 m have sections far shorter; the Space Station's arm moves 116 t and weighs 1.5 t."""
    assert LONGEST >= 100 and HEAVIEST > 116 / 1.5
