"""Families of effects: one effect at all places of a kind as one hypothesis."""

import json
from math import exp, gamma, log, pi, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import dblquad
from tests.helpers.soft_arms import JOINTS, poses_of, soft_arm

import flexarm
from flexarm import Arm, InvalidParameter
from flexarm.arm.effect import effect_class
from flexarm.arm.prior import Prior
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import Candidate, with_members
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.family import EffectFamily, HierarchicalPrior, family_of
from flexarm.diagnosis.moves.families import _in_place_of_singles, without_idle_places
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import FamilyPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import Probed
from flexarm.effects.encoder_offset import EncoderOffset
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.effects.joint_tilt_compliance import JointTiltCompliance

pytestmark = pytest.mark.slow

STIFFNESS = dict(zip(JOINTS, (2.0e4, 2.4e4, 4.3e4, 1.9e4, 3.4e4, 3.9e4, 2.1e4), strict=True))
PRIOR = Prior(1e2, 1e6, 1e4, "log", "N m/rad", "test")


def springs(*joints: str) -> list[JointCompliance]:
    return [JointCompliance(at=joint, stiffness=STIFFNESS[joint]) for joint in joints]


def diagnosed(effects, count: int, seed: int = 1, **options):
    records = {"poses": poses_of(effects, seed, count=count)}
    held = poses_of(effects, seed + 100, 15, count)
    return flexarm.diagnose(soft_arm(count), records, held, n_jobs=1, laws=False, **options)


# ----------------------------------------------------------------------------------------------- the prior


@pytest.mark.parametrize("offsets", [(-0.3, 0.1, 0.2, -0.1, 0.4), (-1.0, 1.2, 0.3, -0.6, 0.1)])
def test_the_cost_of_mean_and_spread_is_near_that_of_their_integral(offsets):
    """Eq. (5): members known exactly, u_i ~ N(mu, tau^2), mu ~ N(m, s^2), tau^2 scaled inverse chi-squared.

    Laplace's approximation of two numbers from five is right within half a unit of ln Z.
    """
    u, tau0, nu = log(2e4) + np.array(offsets), 1.0, 2.0
    start = HierarchicalPrior.of(PRIOR, FamilyPolicy(tau0, nu))
    m, s = start.hyperprior
    found = start
    for _ in range(50):
        found = found.updated(u, np.zeros(len(u)))

    def density(x: float, mu: float) -> float:
        scale = nu * tau0**2 / 2
        of_x = scale ** (nu / 2) / gamma(nu / 2) * exp(-nu / 2 * x - scale * exp(-x))
        of_mu = exp(-(((mu - m) / s) ** 2) / 2) / (s * sqrt(2 * pi))
        of_u = np.prod(np.exp(-((u - mu) ** 2) / 2 / exp(x)) / sqrt(2 * pi * exp(x)))
        return float(of_x * of_mu * of_u)

    exact = log(dblquad(density, m - 6 * s, m + 6 * s, -6.0, 5.0, epsabs=1e-12)[0])
    z = (u - found.mean) / found.spread
    members = -np.sum(z**2) / 2 - len(u) * log(found.spread * sqrt(2 * pi))
    assert members + found.log_evidence(len(u)) == pytest.approx(exact, abs=0.5)


def test_a_member_that_nothing_tells_has_the_shared_size_and_spread():
    found = (
        HierarchicalPrior.of(PRIOR, FamilyPolicy(1.0, 2.0))
        .updated(log(2e4) + np.zeros(20), np.zeros(20))
        .member_prior()
    )
    assert found.typical == pytest.approx(2e4, rel=0.02)
    assert log(found.high / found.low) == pytest.approx(2 * 1.96 * sqrt(2 / 22), rel=1e-3)  # eq. (3)


# ------------------------------------------------------------------------------------------- the candidate


def family(shared: bool = True) -> EffectFamily:
    members = [
        Candidate(each, ("stiffness", "damping"), (each,), {"damping": 0.0}) for each in springs("j1", "j2")
    ]
    found = family_of(members, soft_arm(2), FamilyPolicy())
    assert found is not None
    return found if shared else found.with_separate_sizes()


def test_a_shared_size_is_that_of_all_places():
    arm = family().with_parameters({"stiffness": 7e3}).enter(soft_arm(2))
    assert [arm.effect("joint_compliance", joint).stiffness for joint in ("j1", "j2")] == [7e3, 7e3]
    assert family().keys_of("stiffness") == [
        f"effects.joint_compliance.{joint}.stiffness" for joint in ("j1", "j2")
    ]


def test_no_model_has_a_spring_both_alone_and_in_a_family():
    """Derivatives had a column fewer than parameters: alternatives of an effect ended in a traceback."""
    [alone] = [Candidate(each, ("stiffness",), (each,), {}) for each in springs("j1")]
    with pytest.raises(InvalidParameter, match="twice at one place"):
        with_members(soft_arm(2), [alone, family()])


def test_an_opened_family_names_each_size_after_its_place():
    found = family(shared=False).with_parameters({"j2.stiffness": 7e3})
    assert found.at == ("j1", "j2")
    assert found.free == ("j1.stiffness", "j1.damping", "j2.stiffness", "j2.damping")
    assert [found.value_of(f"{joint}.stiffness") for joint in found.at] == [STIFFNESS["j1"], 7e3]
    assert [found.is_size(name) for name in found.free] == [True, False, True, False]
    assert found.without_place("j1").at == ("j2",)


def test_only_sizes_are_alike_and_their_priors_count_in_full():
    """A damping shapes the law: it keeps the effect's own prior, weighed by a ninth as all others."""
    found, arm = family(shared=False), soft_arm(2)
    priors = found.priors_in(arm)
    assert list(found.hierarchy) == ["stiffness"]
    assert priors["j1.stiffness"].typical == pytest.approx(
        STIFFNESS["j1"]
    )  # the shared size it was opened at
    assert priors["j1.damping"] == found.members[0].priors_in(arm)["damping"]
    assert [found.prior_weight(name) for name in found.free[:2]] == [1.0, 1 / 3]


# ------------------------------------------------------------------------------------------- the diagnosis


@pytest.fixture(scope="module")
def soft():
    """Seven soft joints, the softest 2.3 times as soft as the stiffest."""
    return diagnosed(springs(*JOINTS), 7)


def test_seven_soft_joints_are_one_family(soft):
    assert soft.verdict == "effects"
    [effect] = soft.effects
    assert (effect.name, effect.at) == ("joint_compliance", JOINTS)
    assert effect.probability > 0.9
    assert [each.name for each in effect.parameters] == [f"{joint}.stiffness" for joint in JOINTS]
    for estimate, joint in zip(effect.parameters, JOINTS, strict=True):
        pull = log(estimate.value / STIFFNESS[joint]) / (estimate.std / estimate.value)
        assert abs(pull) < 3.5
    gap = soft.gap(soft.held_out)
    assert gap.before_rms > 20 * gap.noise_rms
    assert gap.after_rms < 1.3 * gap.noise_rms


def test_a_joint_about_the_vertical_is_as_soft_as_the_others(soft):
    """No weight turns it: its size is the shared one, known to the spread of the others."""
    first, *others = soft.effects[0].parameters
    mean = np.exp(np.mean([log(each.value) for each in others]))
    assert abs(log(first.value / mean)) < 0.3
    assert first.low90 < STIFFNESS["j1"] < first.high90
    assert first.std / first.value > 0.3


def test_files_name_a_family_with_all_its_places(soft, tmp_path):
    soft.save(tmp_path / "out")
    [effect] = json.loads((tmp_path / "out/report.json").read_text())["effects"]
    assert effect["at"] == list(JOINTS)
    updated = Arm.from_toml(tmp_path / "out/updated.toml")
    sizes = {e.at: e.stiffness for e in updated.effects if e.name == "joint_compliance"}
    assert sizes == pytest.approx(
        {p["name"].split(".")[0]: p["value"] for p in effect["parameters"]}, rel=1e-3
    )
    total = flexarm.compare(updated, poses_of(springs(*JOINTS), 101, 15)).signals["tip"].rms["total"]
    assert total == pytest.approx(soft.gap(soft.held_out).after_rms, rel=1e-6)
    again = flexarm.Diagnosis.load(tmp_path / "out")
    assert again.effects[0].at == JOINTS
    assert "joint compliance at 7 joints" in again.summary()
    assert "joint compliance at 7 joints" in (tmp_path / "out/report.html").read_text()


def test_one_soft_joint_of_five_is_no_family():
    [effect] = diagnosed(springs("j3"), 5).effects
    assert (effect.name, effect.at) == ("joint_compliance", "j3")


def test_two_soft_joints_of_seven_are_two_effects():
    found = diagnosed(springs("j2", "j4"), 7)
    assert {(each.name, each.at) for each in found.effects} == {
        ("joint_compliance", "j2"),
        ("joint_compliance", "j4"),
    }


def test_places_that_the_data_exclude_leave_a_family():
    """The third joint is rigid; the first one's size nobody sees, so that it stays."""
    [effect] = diagnosed(springs("j1", "j2", "j4", "j5", "j6", "j7"), 7).effects
    assert (effect.name, effect.at) == ("joint_compliance", ("j1", "j2", "j4", "j5", "j6", "j7"))


def test_a_rigid_arm_has_no_family():
    found = diagnosed([], 5)
    assert (found.verdict, found.effects) == ("adequate", ())


def test_zeros_of_all_encoders_are_one_family():
    """Errors of either sign have no shared value; the first zero turns the frame, which nobody knows."""
    zeros = dict(zip(JOINTS, (0.0, 5e-3, -4e-3, 6e-3, -3e-3), strict=False))
    found = diagnosed([EncoderOffset(at=joint, offset=value) for joint, value in zeros.items()], 5)
    [effect] = found.effects
    assert (effect.name, effect.at) == ("encoder_offset", JOINTS[:5])
    for estimate in effect.parameters[1:]:
        value = zeros[estimate.name.removesuffix(".offset")]
        assert abs(estimate.value - value) < 4 * estimate.std


def test_a_family_takes_the_place_of_singles_and_not_of_a_family_that_places_left():
    class Tried:
        def trial(self, members, best, limit):
            return members

    whole, single = family(), family().members[0]
    for known, replaced in ((single, True), (family(shared=False).without_place("j1"), False)):
        best = SimpleNamespace(members=(known,))
        found = _in_place_of_singles(Tried(), [Probed(whole, np.zeros((1, 2)))], best, 1.0)
        assert [[m.at for m in members] for members in found] == ([[("j1", "j2")]] if replaced else [])


def test_places_leave_each_of_two_families():
    """Of five joints four are soft about their axes and all tilt: one place leaves the first family.

    Fits of a smaller first family make another object of the second one, of which all places are kept.
    """
    names = JOINTS[:5]
    tilts = [JointTiltCompliance(at=joint, stiffness=6e4) for joint in names]
    problem = Problem(
        soft_arm(5), {"poses": poses_of([*springs("j1", "j2", "j4", "j5"), *tilts], 2, 60, 5)}, jobs=1
    )
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    found = candidates(problem, estimator.nuisance.arm)
    both = [
        family_of(
            [c for c in found if c.name == kind.name and c.at in names][:5], problem.arm, FamilyPolicy()
        )
        for kind in (JointCompliance, JointTiltCompliance)
    ]
    null = estimator.fit(())
    fit = estimator.trial(both, null)
    assert [len(member.members) for member in fit.members] == [5, 5]
    fewer, _ = without_idle_places(Criteria(problem, null), fit, estimator)
    assert {member.name for member in fewer.members} == {"joint_compliance", "joint_tilt_compliance"}
    assert len(fewer.spots) == sum(len(member.spots) for member in fewer.members) < 10


@pytest.mark.parametrize(
    ("effect", "forms"),
    [("joint_compliance", True), ("encoder_offset", True), ("encoder_scale", False), ("gear_ratio", False)],
)
def test_mistaken_counts_and_ratios_form_no_family(effect, forms):
    """Seven scales at once took the place of the one column that bends."""
    assert effect_class(effect).forms_families() is forms
