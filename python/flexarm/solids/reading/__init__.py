"""Mesh files of other programs."""

from flexarm.solids.reading.read import read_mesh

__all__ = ["read_mesh"]
