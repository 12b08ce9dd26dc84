"""Calibration: estimates of all that a model leaves uncertain, and of families of effects."""
