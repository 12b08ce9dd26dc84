"""Equilibrium of a loaded arm at rest."""

from flexarm.statics.part_shape import PartShape
from flexarm.statics.static import static
from flexarm.statics.statics import Statics

__all__ = ["PartShape", "Statics", "static"]
