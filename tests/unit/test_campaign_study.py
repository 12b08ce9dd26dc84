"""A study that is at fault is told with file, key, value and what is allowed."""

import re

import pytest
from campaign_runs import SIMULATED, STATIC, study_in

from flexarm import InvalidFile, InvalidParameter
from flexarm.campaigns.plan import planned

FLEET = """
format = "flexarm-study/1"
run = "diagnose"
model = "arm.toml"
records = ["{m}/{d}/slow", "{m}/{d}/fast"]
"""


@pytest.mark.parametrize(
    ("old", "new", "where", "what"),
    [
        ('run = "simulate"', 'run = "simulat"', "run", "must be 'simulate', 'static', 'modes' or 'diagnose'"),
        ('"arm.toml"', '"leg.toml"', "model", "there is no .*leg.toml"),
        ('"swing.csv"', '"swung.csv"', "drive", "there is no .*swung.csv"),
        ("n = 16", "n = 0", "sampling.n", "at least 1, got 0"),
        ("n = 16\n", "", "sampling.n", "is missing"),
        ('"sobol"', '"halton"', "sampling.method", "must be 'sobol', 'latin-hypercube', 'random' or 'grid'"),
        ('"sobol"', '"grid"', "sampling.n", "leave it out"),
        ("seed = 1", "sed = 1", "sampling.sed", "unknown key; allowed are .*did you mean 'seed'"),
        (
            "payloads.load.mass",
            "payloads.lod.mass",
            r"vary\[0\].parameter",
            "there is no 'lod' in payloads; there are load",
        ),
        ("payloads.load.mass", "payloads.load.weight", r"vary\[0\].parameter", "there is no value 'weight'"),
        ("effects.backlash", "effects.backslash", r"vary\[1\].parameter", "backslash"),
        ("backlash.hinge", "backlash.elbow", r"vary\[1\].parameter", "elbow"),
        ("std = 0.1", "std = -0.1", r"vary\[0\].std", "must be positive, got -0.1"),
        ("std = 0.1\n", "", r"vary\[0\].std", "is missing; distribution 'normal' needs std"),
        ("std = 0.1", "std = 0.1\nlow = 1.0", r"vary\[0\].low", "does not belong to distribution 'normal'"),
        ("high = 1e-3", "high = 1e-6", r"vary\[1\].high", "must be greater than low"),
        ('"uniform"', '"triangular"', r"vary\[1\].distribution", "must be 'normal', 'lognormal', 'uniform'"),
        ('"position"', '"positions"', r"keep\[0\].quantity", "must be one of position, orientation"),
        ('"tip"', '"top"', r"keep\[0\].point", "there is no point 'top'; there are tip"),
        ('point = "tip"', 'joint = "hinge"', r"keep\[0\].joint", "position is not measured at a joint"),
        ('"final"', '"mean"', r"keep\[0\].statistics\[2\]", "must be 'rms', 'max' or 'final'"),
        ("rate_hz = 10", "count = 2", r"keep\[0\].count", "unknown key"),
        ("step = 5e-3", "count = 3", "count", "belongs to modes"),
        ('drive = "swing.csv"', 'records = ["a"]', "records", "does not belong to run = 'simulate'"),
        (
            'parameter = "payloads.load.mass"',
            'parameter = "gravity"',
            r"vary\[0\].parameter",
            "must read TABLE.NAME.VALUE",
        ),
    ],
)
def test_a_wrong_value_is_told_with_its_place(tmp_path, old, new, where, what):
    assert old in SIMULATED
    file = study_in(tmp_path, SIMULATED.replace(old, new, 1))
    with pytest.raises(InvalidFile) as caught:
        planned(file)
    lines = caught.value.lines()
    assert any(re.search(rf"study.toml: {where}( \(line \d+\))?: .*{what}", line) for line in lines), lines


def test_a_parameter_without_any_uncertainty_asks_for_a_distribution(tmp_path):
    text = SIMULATED.replace('distribution = "normal"\nstd = 0.1', "").replace(
        "payloads.load.mass", "links.rod.material.density"
    )
    with pytest.raises(
        InvalidFile,
        match=r"vary\[0\].distribution.*states no uncertainty of links.rod.material.density, but of",
    ):
        planned(study_in(tmp_path, text))


def test_the_models_uncertainty_is_the_default_distribution(tmp_path):
    """1 % of 2 kg, and 1 mm for each component of a position."""
    text = SIMULATED.replace('distribution = "normal"\nstd = 0.1', "")
    text += '[[vary]]\nparameter = "points.tip.position"\n'
    variation = planned(study_in(tmp_path, text)).variation
    shapes = dict(zip(variation.keys, (each.numbers for each in variation.distributions), strict=True))
    assert shapes["payloads.load.mass"] == pytest.approx((2.0, 0.02))
    assert [shapes[f"points.tip.position.{axis}"] for axis in "xyz"] == [(0, 1e-3), (0, 1e-3), (1, 1e-3)]


def test_an_effect_that_the_model_has_not_is_added_for_the_variants_alone(tmp_path):
    plan = planned(study_in(tmp_path))
    assert plan.arm.effect("backlash", "hinge") is None
    assert plan.variation.arm([2.0, 7e-4]).effect("backlash", "hinge").gap == 7e-4
    assert plan.coordinates()["effects.backlash.hinge.gap"][1] == {"units": "rad"}


def test_statistics_and_rates_belong_to_simulations(tmp_path):
    with pytest.raises(InvalidFile, match=r"keep\[0\].rate_hz .*belongs to run = 'simulate'"):
        planned(study_in(tmp_path, f"{STATIC}rate_hz = 5\n"))


def test_sobol_points_that_are_not_balanced_are_remarked(tmp_path):
    (remark,) = planned(study_in(tmp_path, SIMULATED.replace("n = 16", "n = 20"))).remarks
    assert str(remark) == "sampling.n: 20 is no power of two; Sobol points are balanced at 16 and 32"


def test_words_in_braces_find_machines_and_days(tmp_path):
    for name in ("m1/d1", "m1/d2", "m2/d1"):
        for record in ("slow", "fast"):
            (tmp_path / name / record).mkdir(parents=True)
    plan = planned(study_in(tmp_path, FLEET))
    assert [dict(case.labels) for case in plan.cases] == [
        {"m": "m1", "d": "d1"},
        {"m": "m1", "d": "d2"},
        {"m": "m2", "d": "d1"},
    ]
    assert plan.cases[2].files == (tmp_path / "m2/d1/slow", tmp_path / "m2/d1/fast")
    assert plan.coordinates()["m"][0] == ["m1", "m1", "m2"]


def test_words_in_braces_are_none_that_results_have(tmp_path):
    (tmp_path / "time_1").mkdir()
    file = study_in(tmp_path, SIMULATED.replace('"swing.csv"', '"time_{time}/swing.csv"'))
    (tmp_path / "time_1/swing.csv").write_text((tmp_path / "swing.csv").read_text())
    with pytest.raises(InvalidFile, match=r"\{time\} is taken; use another word"):
        planned(file)


def test_the_urdf_of_a_model_is_an_input(tmp_path):
    """So that a campaign does not go on with another machine."""
    file = study_in(tmp_path, STATIC)
    (tmp_path / "whole.urdf").write_text(
        '<robot name="r"><link name="world"/><link name="rod"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="hinge" type="continuous"><parent link="world"/><child link="rod"/></joint></robot>'
    )
    load = '[[payloads]]\nname = "load"\nlink = "rod"\nmass = 2.0\nposition = [0, 0, 1]\n'
    point = '[[points]]\nname = "tip"\nlink = "rod"\nposition = [0, 0, 1]\n'
    (tmp_path / "arm.toml").write_text(f'format = "flexarm-arm/1"\nurdf = "whole.urdf"\n{load}{point}')
    assert {"arm.toml", "whole.urdf"} <= set(planned(file).inputs)


def test_numbers_of_one_table_vary_together(tmp_path):
    """Of inertias x and y up to 2.5 and z = 1 each step alone may break x <= y + z, together none does."""
    old = STATIC[STATIC.index("[[vary]]") : STATIC.index("[[keep]]")]
    vary = (
        '[[vary]]\nparameter = "payloads.load.inertia.{}"\ndistribution = "uniform"\nlow = 1.5\nhigh = 2.5\n'
    )
    new = "".join(vary.format(axis) for axis in "xy")
    file = study_in(tmp_path, STATIC.replace(old, new))
    text = (tmp_path / "arm.toml").read_text()
    (tmp_path / "arm.toml").write_text(
        text.replace("[[payloads]]", "[[payloads]]\ninertia = [1.9, 1.9, 1.0]", 1)
    )
    arm = planned(file).variation.arm([2.45, 2.4])
    assert arm.payloads[0].inertia[:2] == (2.45, 2.4)
    with pytest.raises(InvalidParameter, match="inertia"):
        planned(file).variation.arm([2.5, 1.4])


def test_records_that_are_nowhere_are_an_error(tmp_path):
    with pytest.raises(InvalidFile, match=r"records\[0\].*there is no .*\{m\}/\{d\}/slow"):
        planned(study_in(tmp_path, FLEET))
    with pytest.raises(
        InvalidFile, match=r"hold_out.*has \{x\}, which the first of records has not; it has d, m"
    ):
        planned(study_in(tmp_path, f'{FLEET}hold_out = "{{m}}/{{x}}/slow"\n'))


def test_files_beside_the_records_of_a_fleet_are_no_records(tmp_path):
    for name in ("m1/d1", "m1/d2"):
        (tmp_path / "fleet" / name).mkdir(parents=True)
    (tmp_path / "fleet/m1/notes.txt").write_text("cleaned the prisms")
    text = FLEET.replace('"{m}/{d}/slow", "{m}/{d}/fast"', '"fleet/{m}/{d}"')
    assert [case.labels["d"] for case in planned(study_in(tmp_path, text)).cases] == ["d1", "d2"]


def test_drives_of_several_patterns_are_told_apart_by_their_files(tmp_path):
    file = study_in(
        tmp_path, SIMULATED.replace('"swing.csv"', '["slow_{load}/swing.csv", "fast_{load}/swing.csv"]')
    )
    for folder in ("slow_a", "fast_a"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "swing.csv").write_text((tmp_path / "swing.csv").read_text())
    labels = [dict(case.labels) for case in planned(file).cases]
    assert labels == [{"load": "a", "drive": f"{each}_a/swing.csv"} for each in ("slow", "fast")]


def test_a_drive_beside_those_of_a_pattern_is_told_by_its_file_as_they_are(tmp_path):
    file = study_in(tmp_path, SIMULATED.replace('"swing.csv"', '["swing.csv", "slow_{load}/swing.csv"]'))
    (tmp_path / "slow_a").mkdir()
    (tmp_path / "slow_a/swing.csv").write_text((tmp_path / "swing.csv").read_text())
    assert [case.labels["drive"] for case in planned(file).cases] == ["swing.csv", "slow_a/swing.csv"]


def test_a_whole_vector_of_an_effect_that_the_model_has_not_varies(tmp_path):
    text = SIMULATED.replace("effects.backlash.hinge.gap", "effects.reflector_offset.tip.offset")
    plan = planned(study_in(tmp_path, text))
    assert plan.variation.keys[1:] == tuple(f"effects.reflector_offset.tip.offset.{axis}" for axis in "xyz")
    assert plan.variation.arm([2.0, 1e-4, 2e-4, 3e-4]).effect("reflector_offset", "tip").offset == (
        1e-4,
        2e-4,
        3e-4,
    )
