"""Arms, parts, results and diagnoses in three dimensions, as pages without network and plain pictures."""

from flexarm.viewer.picture import draw
from flexarm.viewer.view import View, view

__all__ = ["View", "draw", "view"]
