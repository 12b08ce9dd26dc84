"""Transient runs of an arm along its drives."""

from flexarm.simulation.progress import Progress, reported
from flexarm.simulation.simulate import simulate
from flexarm.simulation.simulation import Simulation

__all__ = ["Progress", "Simulation", "reported", "simulate"]
