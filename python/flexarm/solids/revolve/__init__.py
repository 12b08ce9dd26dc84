"""Meshes of bodies of revolution: rings, tubes, shafts, flanges, stacks of them."""

from flexarm.solids.revolve.parts import disc, flange, ring, shaft, tube
from flexarm.solids.revolve.profile import Block, BoltCircle, Patch
from flexarm.solids.revolve.revolved import revolved

__all__ = ["Block", "BoltCircle", "Patch", "disc", "flange", "revolved", "ring", "shaft", "tube"]
