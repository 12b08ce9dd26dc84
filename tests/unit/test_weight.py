"""The weight statement agrees with handbooks and with sums over small pieces."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from arms import TUBE, fixed, hinge, rigid
from arms import beam as steel_beam
from pytest import approx

from flexarm import Arm
from flexarm.arm.weight import Body, combined, link_frames, weight_statement


def beam(end: list[float], section: dict[str, Any], **more: Any) -> dict[str, Any]:
    return steel_beam("rod", end, section, **{"theory": "timoshenko", **more})


def arm_of(link: dict[str, Any], **more: Any) -> Arm:
    return Arm.from_dict({"joints": [hinge("hinge", link["name"])], "links": [link], **more})


def test_the_tube_of_the_paper_weighs_what_the_design_says() -> None:
    """Outside 60.24 mm, wall 3.25 mm, 3 m of steel: 13.7 kg."""
    tube = {"shape": "tube", "outer_diameter": 0.06024, "thickness": 3.25e-3}
    whole = weight_statement(arm_of(beam([0, 0, 3], tube))).whole
    assert whole.mass == approx(13.70, abs=0.01)
    assert whole.centre == approx((0, 0, 1.5))


def test_a_cylinder_has_the_inertia_of_the_handbook() -> None:
    """J = m r^2/2 about the axis and m (3 r^2 + L^2)/12 across it."""
    body = weight_statement(arm_of(beam([0, 2, 0], {"shape": "round", "diameter": 0.1}))).links["rod"]
    m = 7850 * pi * 0.05**2 * 2
    across, along = m * (3 * 0.05**2 + 2**2) / 12, m * 0.05**2 / 2
    assert np.array(body.inertia) == approx(np.diag([across, along, across]), rel=1e-12, abs=1e-12)


def test_a_rectangular_bar_has_the_inertia_of_a_block_in_its_own_axes() -> None:
    """Width 0.02 along y, height 0.1 along z (= up), 1 m along x."""
    section = {"shape": "rectangle", "width": 0.02, "height": 0.1}
    body = weight_statement(arm_of(beam([1, 0, 0], section, up=[0, 0, 1]))).links["rod"]
    m = 7850 * 0.002
    expected = m / 12 * np.diag([0.02**2 + 0.1**2, 1 + 0.1**2, 1 + 0.02**2])
    assert np.array(body.inertia) == approx(expected, rel=1e-12, abs=1e-12)


def test_without_rotary_inertia_a_beam_is_a_thin_rod_across() -> None:
    thin = beam([0, 0, 2], {"shape": "round", "diameter": 0.1}, theory="euler-bernoulli")
    body = weight_statement(arm_of(thin)).links["rod"]
    assert body.inertia[0][0] == approx(body.mass * 4 / 12, rel=1e-12)
    assert body.inertia[2][2] == approx(body.mass * 0.05**2 / 2, rel=1e-12)


def test_payloads_count_in_the_whole_and_not_in_the_link() -> None:
    load = {"name": "load", "link": "rod", "position": [0, 0, 3], "mass": 14.1, "inertia": [0.1, 0.1, 0.1]}
    statement = weight_statement(arm_of(beam([0, 0, 3], TUBE), payloads=[load]))
    rod = statement.links["rod"]
    assert rod.centre == approx((0, 0, 1.5))
    assert statement.whole.mass == approx(rod.mass + 14.1)
    assert statement.whole.centre[2] == approx((1.5 * rod.mass + 3 * 14.1) / (rod.mass + 14.1))
    reduced = rod.mass * 14.1 / (rod.mass + 14.1)  # two bodies 1.5 m apart turn like their reduced mass
    assert statement.whole.inertia[0][0] == approx(rod.inertia[0][0] + 0.1 + reduced * 1.5**2)


def test_two_bodies_as_one_have_the_inertia_of_their_particles() -> None:
    """Against the sum over point masses, whose inertia is m (r.r 1 - r r^T) by definition."""
    rng = np.random.default_rng(1)
    points, masses = rng.normal(size=(6, 3)), rng.uniform(1, 2, 6)
    zero = ((0.0,) * 3,) * 3
    parts = [
        combined([Body(m, tuple(p), zero) for m, p in zip(masses[half], points[half], strict=True)])
        for half in (slice(0, 2), slice(2, 6))
    ]
    whole = combined(parts)
    centre = masses @ points / masses.sum()
    arms = points - centre
    expected = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
    assert whole.centre == approx(centre)
    assert np.array(whole.inertia) == approx(expected)


def test_link_frames_follow_ends_of_beams_and_turned_origins() -> None:
    """A forearm on the far end of an upright beam, turned by 90 degrees about y, points along x."""
    turned = {"xyz": [0, 0, 0.1], "rpy": [0, pi / 2, 0]}
    joints = [
        hinge("a", "rod", origin={"xyz": [0, 0, 0.5]}),
        fixed("b", "forearm", "rod", at="end", origin=turned),
    ]
    links = [
        beam([0, 0, 2], {"shape": "round", "diameter": 0.1}),
        rigid("forearm", 3.0, [0, 0, 1], [1, 2, 2.5]),
    ]
    arm = Arm.from_dict({"joints": joints[::-1], "links": links})
    rotation, position = link_frames(arm)["forearm"]
    assert position == approx((0, 0, 2.6))
    assert np.array(rotation) @ [0, 0, 1] == approx([1, 0, 0])
    forearm = weight_statement(arm).links["forearm"]
    assert forearm.centre == approx((1, 0, 2.6))
    assert np.array(forearm.inertia) == approx(np.diag([2.5, 2, 1]), abs=1e-12)


def test_the_whole_of_case_18_is_the_sum_of_its_parts(shared_dir: Path) -> None:
    statement = weight_statement(Arm.from_toml(shared_dir / "cases/case_18/model.toml"))
    assert statement.whole.mass == approx(
        sum(b.mass for b in (*statement.links.values(), *statement.payloads.values()))
    )
