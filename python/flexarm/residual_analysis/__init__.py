"""Analysis of residuals: where they lie, at which frequencies, and which states of the motion they follow."""
