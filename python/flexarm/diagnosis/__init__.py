"""Where simulation and measurement disagree, which effect is missing, and how the gap shrinks with it."""
