"""Measurement: sensors, clocks and frames, and the smoothing of measured drives."""

from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import Registration
from flexarm.measurement.measure import measure
from flexarm.measurement.predict import predict
from flexarm.measurement.sampling import CannotMeasure
from flexarm.measurement.slopes import predict_slopes
from flexarm.measurement.smoothing import interpolate, smooth

__all__ = [
    "CannotMeasure",
    "ClockError",
    "Registration",
    "interpolate",
    "measure",
    "predict",
    "predict_slopes",
    "smooth",
]
