"""Equilibrium of a loaded arm at rest."""

from flexarm.statics.static import static
from flexarm.statics.statics import PartShape, Statics

__all__ = ["PartShape", "Statics", "static"]
