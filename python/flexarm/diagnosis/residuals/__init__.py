"""What was measured beside what a model predicts of it, over its noise; and how it changes with the model."""
