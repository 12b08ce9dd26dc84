"""Where simulation and measurement disagree, which physical effect is missing, and how the gap shrinks with it."""
