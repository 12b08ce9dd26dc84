"""One step at a time, for users with a controller of their own."""

from flexarm.stepping.readings import JointReading, PointReading
from flexarm.stepping.state import State
from flexarm.stepping.stepper import Stepper

__all__ = ["JointReading", "PointReading", "State", "Stepper"]
