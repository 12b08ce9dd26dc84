"""Linear models of an arm near a loaded equilibrium, for control design."""

from flexarm.linear.linear_model import LinearModel
from flexarm.linear.linearise import linearise

__all__ = ["LinearModel", "linearise"]
