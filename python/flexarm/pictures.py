"""The way from models and results up to `flexarm.viewer`, which knows them all; none of them knows it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.viewer import View


def viewed(of: Any, **options: Any) -> View:
    """Return the page of a model or result in three dimensions; see `flexarm.viewer.view`."""
    page: View = import_module("flexarm.viewer").view(of, **options)
    return page


def drawn(of: Any, **options: Any) -> Axes:
    """Return the axes of a picture without a browser; see `flexarm.viewer.draw`."""
    axes: Axes = import_module("flexarm.viewer").draw(of, **options)
    return axes


class Shown:
    """Base of what a notebook shows as its summary, where that is more than `repr` tells."""

    def _repr_html_(self) -> str:
        from html import escape  # not before a notebook asks

        return f"<pre>{escape(getattr(self, 'summary', self.__repr__)())}</pre>"


class Summarised(Shown):
    """Base of results that print as their summary."""

    def summary(self) -> str:
        """Return the result as text."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return self.summary()
