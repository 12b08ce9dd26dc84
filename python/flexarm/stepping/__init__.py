"""One step at a time, for users with a controller of their own."""

from flexarm.stepping.state import JointReading, PointReading, State
from flexarm.stepping.stepper import Stepper

__all__ = ["JointReading", "PointReading", "State", "Stepper"]
