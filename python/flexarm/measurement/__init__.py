"""What an experiment sees: sensors, clocks and frames, and the smoothing of measured drives."""
