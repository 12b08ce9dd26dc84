"""From a solid mesh to a super-element."""

from flexarm.reduction.interface_set import InterfaceSet
from flexarm.reduction.part import reduce_mesh

__all__ = ["InterfaceSet", "reduce_mesh"]
