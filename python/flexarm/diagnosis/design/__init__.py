"""Design of experiments: which effects an experiment could tell apart, and what to measure next."""
