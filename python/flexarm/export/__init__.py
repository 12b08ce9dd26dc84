"""What was found or reduced, in the files of other programs: URDF, MJCF, Simscape, Nastran and Abaqus."""

from flexarm.export.mjcf import export_mjcf
from flexarm.export.part import export_part
from flexarm.export.urdf import export_urdf

__all__ = ["export_mjcf", "export_part", "export_urdf"]
