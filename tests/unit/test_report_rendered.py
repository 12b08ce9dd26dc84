"""Solids drawn by a renderer in a process of its own, or not at all."""

import sys

import numpy as np
import pytest

from flexarm.reproduction import rendered as module
from flexarm.reproduction.rendered import rendered

SQUARE = (np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]]), ((0, 1, 2, 3),), np.array([0, 0, 1, 1.0]))


def test_without_the_extra_there_is_no_image(monkeypatch):
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    assert rendered([SQUARE], 1.0, "viridis", (0.0, -90.0)) is None


def test_a_renderer_that_fails_leaves_no_image(monkeypatch):
    monkeypatch.setattr(module, "find_spec", lambda name: True)
    monkeypatch.setattr(sys, "executable", "/bin/false")
    assert rendered([SQUARE], 1.0, "viridis", (0.0, -90.0)) is None


@pytest.mark.slow
def test_a_square_seen_from_the_front_is_a_square_that_is_yellow_at_the_top():
    image = rendered([SQUARE], 1.0, "viridis", (0.0, -90.0))
    if image is None:
        pytest.skip("pyvista cannot render here")
    height, width = image.shape[:2]
    assert abs(height - width) <= 0.02 * width
    top, bottom = image[height // 10, width // 2], image[-height // 10, width // 2]
    assert top[0] > top[2] and bottom[2] > bottom[0]  # viridis runs from violet to yellow
