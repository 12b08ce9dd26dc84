"""Effects at payloads, links, the base and points: files, places, values, order."""

import numpy as np
import pytest
from arms import LENGTH, PAYLOAD, arm, beam, fixed, general, hinge, paper_arm, rigid
from part_arms import tube_part

from flexarm import Arm, InvalidFile, InvalidParameter, Record, Signal, modes, static
from flexarm.arm import KNOWN_EFFECTS
from flexarm.arm.weight import weight_statement
from flexarm.assembly import assemble, machine_of
from flexarm.assembly.as_built import as_built, weight_as_built
from flexarm.comparison.poses import solve_poses
from flexarm.effects import (
    BaseCompliance,
    BaseTilt,
    Effect,
    ExternalVibration,
    LinkBow,
    LinkDamping,
    LinkLength,
    LinkMass,
    LinkStiffness,
    PayloadInertia,
    PayloadMass,
    PayloadOffset,
    ReflectorOffset,
)
from flexarm.record.table import CarriedPayload

EXAMPLES = [
    PayloadMass(at="load", mass=15.0),
    PayloadOffset(at="load", offset=(0.01, 0.0, -0.02)),
    PayloadInertia(at="load", inertia=(0.1, 0.12, 0.05)),
    LinkLength(at="rod", error=2e-3),
    LinkStiffness(at="rod", scale=0.9),
    LinkMass(at="rod", scale=1.1),
    LinkDamping(at="rod", damping_ratio=0.01),
    LinkBow(at="rod", tip_offset=(3e-3, 0.0, 1e-4), time_constant=300.0),
    BaseTilt(at="base", angle=(1e-3, -2e-3)),
    BaseCompliance(at="base", stiffness=1e6, damping=500.0),
    ExternalVibration(at="base", amplitude=5.0, frequency=4.0, phase=0.3),
    ReflectorOffset(at="tip", offset=(1e-3, 0.0, 2e-3)),
]
by_name = pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)


def with_all(*effects: Effect) -> Arm:
    return paper_arm(2).replace(effects=effects)


# ----------------------------------------------------------------------- files and text


def test_every_effect_of_these_places_is_here():
    places = ("payload", "link", "base", "point")
    assert {e.name for e in EXAMPLES} == {name for name, place in KNOWN_EFFECTS.items() if place in places}


def test_a_model_with_all_effects_is_read_back_as_it_was_written(tmp_path):
    written = with_all(*EXAMPLES)
    written.to_toml(tmp_path / "arm.toml")
    assert Arm.from_toml(tmp_path / "arm.toml") == written


@by_name
def test_every_parameter_is_printed_with_its_unit_and_has_a_prior(effect):
    priors = effect.priors(paper_arm(2))
    parameters = effect.parameters()
    assert list(priors) == [name for name, _, _ in parameters]
    for name, value, unit in parameters:
        assert f"{name} = {value:g} {unit}" in str(effect)
        assert priors[name].unit == unit
        assert priors[name].source
        assert priors[name].low < value < priors[name].high
        assert effect.derivative(name) == "smooth"


def test_vectors_are_spelt_out():
    assert str(EXAMPLES[8]) == "base_tilt at base: angle.x = 0.001 rad, angle.y = -0.002 rad"
    assert str(PayloadInertia(at="load", inertia=0.2)) == "payload_inertia at load: inertia = 0.2 kg m2"
    shifted = EXAMPLES[-1].with_parameters({"offset.y": 5e-4})
    assert shifted == ReflectorOffset(at="tip", offset=(1e-3, 5e-4, 2e-3))


def test_a_time_constant_of_zero_is_not_the_limit_of_short_ones():
    assert LinkBow(at="rod", tip_offset=(1e-3, 0, 0)).derivative("time_constant") == "none"


@pytest.mark.parametrize(
    "effect", [e for e in EXAMPLES if e.name != "external_vibration"], ids=lambda e: e.name
)
def test_parameters_left_out_are_without_effect(effect):
    """The arm stands where it stood, but for rounding."""
    idle = paper_arm(2).with_effect(type(effect)(at=effect.at))
    q = {"hinge": 0.7}
    assert static(idle, q).position == pytest.approx(static(paper_arm(2), q).position, abs=1e-14)


# ------------------------------------------------------------------------- wrong places


@pytest.mark.parametrize(
    ("table", "what"),
    [
        ({"name": "payload_mass", "at": "tip", "mass": 1.0}, "there is no payload 'tip'; there are load"),
        ({"name": "link_bow", "at": "load"}, "there is no link 'load'; there are rod"),
        ({"name": "base_tilt", "at": "hinge"}, "there is no base 'hinge'; there are base"),
        ({"name": "reflector_offset", "at": "base"}, "there is no point 'base'; there are tip"),
    ],
)
def test_a_wrong_place_is_told_with_those_that_exist(table, what, tmp_path):
    data = paper_arm(1).to_dict()
    with pytest.raises(InvalidParameter, match=f"effects.{table['name']}.{table['at']}.at: {what}"):
        Arm.from_dict({**data, "effects": [table]})
    paper_arm(1).to_toml(tmp_path / "arm.toml")
    text = (tmp_path / "arm.toml").read_text()
    lines = "\n".join(f"{key} = {value!r}" for key, value in table.items())
    (tmp_path / "arm.toml").write_text(f"{text}\n[[effects]]\n{lines}\n")
    with pytest.raises(InvalidFile, match=rf"arm\.toml: effects.*at \(line \d+\): {what}"):
        Arm.from_toml(tmp_path / "arm.toml")


@pytest.mark.parametrize(
    ("effect", "what"),
    [
        (LinkStiffness(at="block", scale=0.9), "'block' is rigid and does not bend; make it a beam"),
        (LinkDamping(at="block", damping_ratio=0.1), "'block' is rigid and damps nothing; joint_compliance"),
        (LinkLength(at="block", error=1e-3), "'block' is a rigid link and has no length"),
        (LinkBow(at="block"), "'block' is a rigid link; only a beam has a bow"),
        (LinkLength(at="rod", error=-2.0), "error: must leave a length of 'rod', 1 m long, got -2 m"),
        (BaseCompliance(at="base", stiffness=1e5), "first revolute joint, and the model has none"),
        (ExternalVibration(at="base", amplitude=1.0), "needs a base_compliance with a stiffness"),
    ],
)
def test_an_effect_that_cannot_act_is_refused_with_what_would(effect, what):
    model = arm(
        joints=[fixed("mount", "block"), fixed("weld", "rod", "block")],
        links=[rigid("block", 1.0), beam("rod", [0, 0, 1], general(1e-4, 1e-8))],
    )
    with pytest.raises(InvalidParameter, match=rf"effects\.{effect.name}\.{effect.at}.*{what}"):
        model.with_effect(effect)


def test_a_vibration_needs_its_base_as_long_as_it_is_there():
    shaken = paper_arm(1).with_effect(EXAMPLES[9]).with_effect(EXAMPLES[10])
    with pytest.raises(InvalidParameter, match="needs a base_compliance"):
        shaken.without_effect("base_compliance", "base")
    with pytest.raises(InvalidParameter, match="needs a base_compliance with a stiffness"):
        shaken.with_effect(BaseCompliance(at="base", damping=1.0))


def test_only_a_beam_among_flexible_links_has_length_and_bow(tmp_path):
    """A super-element has neither; its matrices are scaled, its damping ratio replaced."""
    tube_part().save(tmp_path / "rod.nc")
    model = arm(
        joints=[hinge("hinge", "rod:start")],
        links=[{"name": "rod", "type": "superelement", "file": str(tmp_path / "rod.nc")}],
        points=[{"name": "tip", "link": "rod:end", "position": [0, 0, 0]}],
    )
    for effect in (LinkLength(at="rod", error=1e-3), LinkBow(at="rod")):
        with pytest.raises(InvalidParameter, match="'rod' is a superelement link"):
            model.with_effect(effect)
    weight = weight_statement(model).whole.mass
    heavy = model.with_effect(LinkMass(at="rod", scale=1.5))
    assert weight_as_built(heavy).whole.mass == pytest.approx(1.5 * weight)
    assert assemble(heavy).mass == pytest.approx(1.5 * weight)
    held = model.with_effect(LinkDamping(at="rod", damping_ratio=0.03))
    assert modes(model, count=1, gravity=False).damping_ratio[0] == 0
    assert modes(held, count=1, gravity=False).damping_ratio[0] == pytest.approx(0.03, rel=1e-6)
    sag = np.abs(static(model).displacement).max()
    soft = np.abs(static(model.with_effect(LinkStiffness(at="rod", scale=0.5))).displacement).max()
    assert soft == pytest.approx(2 * sag, rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "values", "what"),
    [
        (PayloadMass, {"mass": -1.0}, "mass: must be at least 0, got -1 kg"),
        (PayloadOffset, {"offset": [1, 2]}, r"offset: must be a list of 3 numbers, got \[1, 2\]"),
        (PayloadInertia, {"inertia": [1, 2]}, r"inertia: must be one number or \[Ixx, Iyy, Izz\]"),
        (PayloadInertia, {"inertia": "big"}, r"inertia: must be one number or \[Ixx, Iyy, Izz\]"),
        (PayloadInertia, {"inertia": [1, 1, 3]}, "inertia: no body has these moments"),
        (PayloadInertia, {"inertia": -0.1}, "inertia: moments of inertia must not be negative"),
        (LinkStiffness, {"scale": 0.0}, "scale: must be positive, got 0"),
        (LinkMass, {"scale": -1.0}, "scale: must be positive, got -1"),
        (LinkDamping, {"damping_ratio": 1.0}, "damping_ratio: must be less than 1, got 1"),
        (LinkBow, {"time_constant": -1.0}, "time_constant: must be at least 0, got -1 s"),
        (LinkBow, {"tip_ofset": [0, 0, 0]}, "tip_ofset: unknown key; .* did you mean 'tip_offset'"),
        (BaseTilt, {"angle": [0, 0, 0]}, "angle: must be a list of 2 numbers"),
        (BaseCompliance, {"stiffness": 0.0}, "stiffness: must be positive, got 0 N m/rad"),
        (ExternalVibration, {"frequency": -1.0}, "frequency: must be at least 0, got -1 Hz"),
        (ReflectorOffset, {"offset": [0, 0, float("nan")]}, "offset.* must be a finite number"),
    ],
)
def test_wrong_values_are_told(kind, values, what):
    with pytest.raises(InvalidParameter, match=what):
        kind(at="rod", **values)


# ----------------------------------------------------------------- order and composition


def test_the_order_in_the_file_does_not_matter():
    """A reflector sits beside the point of the longer link, whichever effect is named first."""
    q = {"hinge": 0.4}
    forward, backward = with_all(*EXAMPLES), with_all(*reversed(EXAMPLES))
    assert np.array_equal(static(forward, q).position, static(backward, q).position)
    tip = machine_of(backward).points["tip"].position
    assert tip == pytest.approx((1e-3, 0.0, LENGTH + 2e-3 + 2e-3))


def test_small_effects_of_different_places_add_up():
    """To first order the tip moves by the sum of what each effect moves; 1 % for what 1 % changes of that."""
    q = {"hinge": 0.9}
    chosen = [
        PayloadMass(at="load", mass=14.2),
        PayloadOffset(at="load", offset=(2e-3, 0.0, -1e-3)),
        LinkLength(at="rod", error=2e-4),
        LinkStiffness(at="rod", scale=0.99),
        LinkMass(at="rod", scale=1.01),
        LinkBow(at="rod", tip_offset=(3e-4, 1e-4, 0.0)),
        BaseTilt(at="base", angle=(1e-4, -2e-4)),
        BaseCompliance(at="base", stiffness=2e7),
        ReflectorOffset(at="tip", offset=(1e-4, 0.0, 2e-4)),
    ]
    plain = static(paper_arm(2), q).position
    alone = sum(static(paper_arm(2).with_effect(e), q).position - plain for e in chosen)
    together = static(with_all(*chosen), q).position - plain
    assert np.linalg.norm(together - alone) < 0.01 * np.linalg.norm(alone)


def test_the_second_of_two_at_one_place_counts():
    twice = with_all(LinkStiffness(at="rod", scale=0.5), LinkStiffness(at="rod", scale=0.9))
    assert machine_of(twice).links["rod"].bending_scale == 0.9


def test_places_on_a_longer_link_follow_and_those_beyond_keep_their_distance():
    model = paper_arm(1).to_dict()
    at = {"middle": [0.1, 0, 1.5], "before": [0, 0, -0.2], "beyond": [0, 0.3, 3.5], "tip": [0, 0, 3]}
    model["points"] = [{"name": name, "link": "rod", "position": place} for name, place in at.items()]
    model["links"].append(rigid("hand", 1.0))
    model["joints"].append(fixed("wrist", "hand", "rod", at="end"))
    model["points"].append({"name": "hand", "link": "hand", "position": [0, 0, 0]})
    longer = Arm.from_dict(model).with_effect(LinkLength(at="rod", error=0.03))
    found = {name: place.position for name, place in machine_of(longer).points.items()}
    assert found["middle"] == pytest.approx((0.1, 0, 1.515))
    assert found["before"] == pytest.approx((0, 0, -0.2))
    assert found["beyond"] == pytest.approx((0, 0.3, 3.53))
    assert found["tip"] == pytest.approx((0, 0, 3.03))
    upright = static(longer).position[-1, 2]
    assert upright == pytest.approx(3.03, abs=1e-5)  # squeezed by its weight


# ------------------------------------------------------------------------ records, weight


def test_a_weighed_payload_wins_over_the_effect():
    carried = Record(signals=[], payloads={"load": CarriedPayload(mass=5.0)})
    applied = carried.applied_to(with_all(PayloadMass(at="load", mass=15.0), EXAMPLES[1]))
    assert machine_of(applied).payloads["load"].mass == 5.0
    assert machine_of(applied).payloads["load"].offset == EXAMPLES[1].offset
    unweighed = Record(signals=[], payloads={"load": CarriedPayload(position=(0, 0, 2.9))})
    assert machine_of(unweighed.applied_to(with_all(EXAMPLES[0]))).payloads["load"].mass == 15.0


def test_a_payload_weighed_in_a_pose_wins_too():
    """Poses with a known payload stand the same whatever mass the model has."""
    pose = np.array(["a", "b"])
    masses = Signal(name="m", quantity="payload_mass", payload="load", values=np.array([5.0, 9.0]), pose=pose)
    angle = Signal(name="q", quantity="joint_angle", joint="hinge", values=np.array([0.5, 1.0]), pose=pose)
    record = Record(kind="static", drive=("q",), signals=[masses, angle])
    plain, wrong = (solve_poses(model, record) for model in (paper_arm(2), with_all(EXAMPLES[0])))
    assert np.array_equal(wrong.position, plain.position)
    assert np.ptp(plain.position[:, 0], axis=0).max() > 0.1


def test_weight_counts_effects():
    """The mass that the system has; the centre of a payload where its offset puts it, the base tilted."""
    changed = with_all(*EXAMPLES)
    found = weight_as_built(changed)
    assert found.whole.mass == pytest.approx(assemble(changed).mass, rel=1e-12)
    assert found.payloads["load"].mass == 15.0
    tilted = weight_as_built(paper_arm(1).with_effect(BaseTilt(at="base", angle=(0.0, 0.1))))
    centre = weight_statement(paper_arm(1)).whole.centre[2]
    assert tilted.whole.centre == pytest.approx((centre * np.sin(0.1), 0, centre * np.cos(0.1)))
    assert tilted.whole.mass == pytest.approx(PAYLOAD + weight_statement(paper_arm(1)).links["rod"].mass)


def test_an_arm_as_built_has_no_effects_and_the_changed_tables():
    built = as_built(machine_of(with_all(*EXAMPLES)))
    assert built.effects == ()
    assert built.link("rod").length == pytest.approx(LENGTH + 2e-3)
    assert built.link("rod").material.density == pytest.approx(1.1 * 7850)
    assert built.payload("load").inertia[:3] == (0.1, 0.12, 0.05)


@by_name
def test_a_system_keeps_its_structure_when_a_parameter_changes(effect):
    """Sensitivities difference two systems: nodes and unknowns are the same a little up and a little down."""
    base = with_all(BaseCompliance(at="base", stiffness=1e6))
    nominal = assemble(base.with_effect(effect))
    size = {(nominal.n_nodes, nominal.n_unknowns)}
    for name, value, _ in effect.parameters():
        for factor in (0.999, 1.001):
            changed = effect.with_parameters({name: factor * value + (factor - 1) * 1e-3 * (value == 0)})
            system = assemble(base.with_effect(changed))
            size.add((system.n_nodes, system.n_unknowns))
    assert len(size) == 1
