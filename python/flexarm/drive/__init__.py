"""Drives of joints: piecewise polynomials in time, one for each driven joint."""

from flexarm.drive.drive import Drive
from flexarm.drive.joint_drive import JointDrive

__all__ = ["Drive", "JointDrive"]
