"""The way from models and results up to `flexarm.viewer`, which knows them all; none of them knows it."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def viewed(of: Any, **options: Any) -> Any:
    """Return the page of a model or result in three dimensions; see `flexarm.viewer.view`."""
    return import_module("flexarm.viewer").view(of, **options)


def drawn(of: Any, **options: Any) -> Any:
    """Return the axes of a picture without a browser; see `flexarm.viewer.draw`."""
    return import_module("flexarm.viewer").draw(of, **options)
