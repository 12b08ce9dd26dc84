"""Reduced matrices of other programs: Matrix Market, Abaqus and CalculiX, Nastran DMIG and OP4."""

from flexarm.superelement.foreign.accept import accept_matrices

__all__ = ["accept_matrices"]
