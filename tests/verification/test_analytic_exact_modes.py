"""Exact modes of the beam with hub spring and tip load, against closed forms, orthogonality and finite
elements.
"""

import math

import numpy as np
import pytest
from pytest import approx

from flexarm.analytic import FlexibleLink, exact_modes
from flexarm.analytic.exact_modes import beam_points, mass_points
from flexarm.errors import InvalidParameter

EI = 210e9 * 2.37e-7


def paper_link(area=5.82e-4, **changes):
    """Table 1 of the paper; the printed area is 5.92e-5 m², the one that agrees with wall and inertia
    5.82e-4 m².
    """
    return FlexibleLink(
        **{
            "length": 3.0,
            "bending_stiffness": EI,
            "mass_per_length": 7850 * area,
            "tip_mass": 14.1,
            **changes,
        }
    )


@pytest.mark.parametrize(
    ("area", "hub_stiffness", "published"),
    [
        (5.82e-4, math.inf, [2.84155, 29.9552, 93.8947]),
        (5.82e-4, 1e5, [2.29633, 24.9427, 81.7074]),
        (5.92e-5, math.inf, [3.11578, 89.7617, 289.724]),
    ],
)
def test_the_papers_arm_has_its_known_frequencies(area, hub_stiffness, published):
    """Independent exact roots, six digits."""
    frequencies = exact_modes(paper_link(area), 3, hub_stiffness).frequency_hz
    assert frequencies == approx(published, rel=3e-6)  # half a unit of the sixth digit


def test_a_load_as_heavy_as_the_beam_has_its_known_wavenumbers():
    """lambda² of a clamped beam with M_e = ρA L."""
    link = paper_link(tip_mass=3.0 * 7850 * 5.82e-4)
    published = [1.557298, 16.25009, 50.89584, 105.1983, 179.2320]
    assert exact_modes(link, 5).wavenumbers ** 2 == approx(published, rel=5e-7)


@pytest.mark.parametrize("hub_stiffness", [math.inf, 3e6, 1e5, 100.0])
def test_roots_satisfy_the_frequency_equation_in_closed_form(hub_stiffness):
    """κ [1 + cos cosh + n lam (cos sinh - sin cosh)] = lam [sin cosh - cos sinh + 2 n lam sin sinh]."""
    link = paper_link()
    n = link.tip_mass / link.beam_mass
    kappa = hub_stiffness * link.length / link.bending_stiffness
    for lam in exact_modes(link, 12, hub_stiffness).wavenumbers:
        c, s, sh = math.cos(lam), math.sin(lam), math.tanh(lam)  # all divided by cosh
        spring = 1 / math.cosh(lam) + c + n * lam * (c * sh - s)
        moment = lam * (s - c * sh + 2 * n * lam * s * sh)
        residual = spring if math.isinf(kappa) else spring - moment / kappa
        scale = (1 + n * lam) * (1 if math.isinf(kappa) else 1 + lam / kappa)
        assert abs(residual) < 1e-12 * scale


@pytest.mark.parametrize(
    ("hub_stiffness", "wavenumbers"),
    [(math.inf, [1.87510407, 4.69409113, 7.85475744]), (0.0, [0.0, 3.92660231, 7.06858275])],
)
def test_a_beam_without_load_is_the_textbook_beam(hub_stiffness, wavenumbers):
    """Clamped-free: cos cosh = -1; pinned-free: tan = tanh."""
    assert exact_modes(paper_link(tip_mass=0.0), 3, hub_stiffness).wavenumbers == approx(
        wavenumbers, abs=1e-8
    )


@pytest.mark.parametrize("hub_stiffness", [math.inf, 1e5, 1.0, 0.0])
@pytest.mark.parametrize("ends", [{}, {"tip_inertia": 0.7, "hub_inertia": 2.0}])
def test_modes_are_orthogonal_in_mass_and_stiffness(hub_stiffness, ends):
    """φᵀ M φ = I with load and hub, φᵀ K φ = diag(omega²) with the spring, for thirty modes."""
    link, count = paper_link(**ends), 30
    modes = exact_modes(link, count, hub_stiffness)
    x, dm = mass_points(link, count)
    hub, tip = modes.shape(0.0, 1)[:, 0], modes.shape(link.length, 1)[:, 0]
    shape = modes.shape(x)
    mass = (
        shape * dm @ shape.T + link.hub_inertia * np.outer(hub, hub) + link.tip_inertia * np.outer(tip, tip)
    )
    assert mass == approx(np.eye(count), abs=1e-12)
    x, weight = beam_points(link, count)
    curvature = modes.shape(x, 2)
    stiffness = EI * (curvature * weight) @ curvature.T
    if math.isfinite(hub_stiffness):
        stiffness += hub_stiffness * np.outer(hub, hub)
    assert stiffness / modes.omega[-1] ** 2 == approx(
        np.diag((modes.omega / modes.omega[-1]) ** 2), abs=1e-12
    )


def test_no_mode_is_missed_or_found_twice():
    """Mode k has k nodes between hub and tip, up to the hundredth; a loaded tip comes to rest, it adds
    none.
    """
    modes = exact_modes(paper_link(tip_mass=0.0), 100, 1e5)
    x = np.linspace(1e-6, 3.0, 20001)
    nodes = np.sum(np.diff(np.sign(modes.shape(x)), axis=1) != 0, axis=1)
    assert nodes.tolist() == list(range(100))


def test_a_soft_hub_spring_swings_the_rigid_arm():
    """omega² = k_r/J_0 for k_r -> 0; the flexible arm is softer by about k_r L/(3 EI)."""
    link, spring = paper_link(), 5.0
    omega = exact_modes(link, 1, spring).omega[0]
    assert omega == approx(math.sqrt(spring / link.joint_inertia), rel=spring * link.length / (3 * EI))


def test_a_heavy_hub_is_a_clamp():
    """A pinned link with J_h -> inf bends as if clamped; the difference falls with J_0/J_h."""
    clamped = exact_modes(paper_link(), 3).frequency_hz
    gap = [
        exact_modes(paper_link(hub_inertia=inertia), 4, 0.0).frequency_hz[1:] / clamped - 1
        for inertia in (1e5, 1e6)
    ]
    assert np.all(gap[0] > 0)
    assert gap[0] / gap[1] == approx(np.full(3, 10.0), rel=0.01)


def test_more_load_and_less_stiffness_lower_every_frequency():
    """Rayleigh: frequencies rise with stiffness and fall with mass."""
    reference = exact_modes(paper_link(), 6, 1e5).frequency_hz
    for heavier in ({"tip_mass": 20.0}, {"tip_inertia": 1.0}, {"hub_inertia": 1.0}):
        assert np.all(exact_modes(paper_link(**heavier), 6, 1e5).frequency_hz < reference)
    assert np.all(exact_modes(paper_link(), 6, 2e5).frequency_hz > reference)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"length": 0.0}, "length"),
        ({"bending_stiffness": -1.0}, "N m²"),
        ({"tip_mass": math.nan}, "tip_mass"),
    ],
)
def test_a_link_names_what_is_wrong_with_it(changes, word):
    with pytest.raises(InvalidParameter, match=word):
        paper_link(**changes)


@pytest.mark.parametrize(
    ("count", "hub_stiffness"), [(0, 1.0), (151, 1.0), (3, -1.0), (3, math.nan), (3, 1e-9)]
)
def test_modes_refuse_what_they_cannot_find(count, hub_stiffness):
    with pytest.raises(InvalidParameter, match=r"number of exact modes|hub s"):
        exact_modes(paper_link(), count, hub_stiffness)
