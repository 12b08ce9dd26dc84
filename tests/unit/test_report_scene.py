"""Figure 6's surfaces: parts, tube and load where statics puts them."""

from pathlib import Path

import numpy as np
import pytest
from hinges import coarse_design
from pytest import approx

import flexarm
from flexarm.mockup import build_hinge
from flexarm.reproduction.scene import Surface, scene
from flexarm.reproduction.variants import Models

ANGLE = 1.1


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Models:
    folder: Path = tmp_path_factory.mktemp("scene")
    hinge = build_hinge(folder, coarse_design())
    return Models(hinge, hinge, folder)


@pytest.fixture(scope="module")
def surfaces(models: Models) -> dict[str, Surface]:
    return {surface.name: surface for surface in scene(models, ANGLE)}


def test_the_base_stays_and_the_load_is_at_the_tip(models: Models, surfaces: dict[str, Surface]) -> None:
    tip = flexarm.static(models.fe, joints={"hinge": ANGLE})
    base = models.hinge.meshes["housing"].point_set("base")
    assert surfaces["housing"].displacement[base].max() < 1e-12
    rigid = tip.position[-1] - tip.displacement[-1]
    assert surfaces["load"].rigid.mean(axis=0) == approx(rigid, abs=1e-12)
    # The drawn tube has six times as many elements, which carry their own weight a little differently.
    assert surfaces["load"].moved.mean(axis=0) == approx(tip.position[-1], abs=2e-5)


def test_parts_and_tube_hold_together_deformed(models: Models, surfaces: dict[str, Surface]) -> None:
    """Interface points follow their frames: the seat's in both parts alike, the pad with the first ring."""
    hub, meshes = surfaces["hub"], models.hinge.meshes
    pad = meshes["hub"].point_set("output")
    ring = slice(0, 24)
    for points in (hub.moved[pad], hub.rigid[pad]):
        gap = points.mean(axis=0) - surfaces["tube"].moved[ring].mean(axis=0)
        assert np.linalg.norm(gap) < 0.01
    spans = [
        np.linalg.norm(points[pad][:, None] - ring_of[None], axis=2)
        for points, ring_of in (
            (hub.rigid, surfaces["tube"].rigid[ring]),
            (hub.moved, surfaces["tube"].moved[ring]),
        )
    ]
    assert spans[0] == approx(spans[1], abs=2e-6)  # first order: 0.1 m times the square of a milliradian
    seat = {
        name: surfaces[name].displacement[meshes[name].point_set(key)].max()
        for name, key in (("housing", "seat"), ("reducer", "input"))
    }
    assert seat["housing"] == approx(seat["reducer"], rel=1e-6)


def test_the_shaft_twists_between_a_still_end_and_a_turned_one(surfaces: dict[str, Surface]) -> None:
    """Its end at the hub moves, its body in the housing hardly does."""
    shaft = surfaces["reducer"]
    end = shaft.rigid[:, 1] > 0.107
    assert shaft.displacement[end].max() > 5 * shaft.displacement[shaft.rigid[:, 1] < -0.0925 - 0.029].max()


def test_scale_multiplies_displacements_and_cutting_keeps_points(surfaces: dict[str, Surface]) -> None:
    hub = surfaces["hub"]
    assert hub.drawn(0.0) == approx(hub.rigid)
    assert hub.drawn(1.0) == approx(hub.moved)
    assert hub.drawn(3.0) - hub.rigid == approx(3 * (hub.moved - hub.rigid))
    opened = hub.opened()
    assert 0 < len(opened.faces) < len(hub.faces)
    assert np.mean([hub.rigid[list(face), 0].mean() for face in opened.faces]) > 0
