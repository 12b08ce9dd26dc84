"""The gallery of effects, docs/effects: what each does to the tip, and what tells it from the others."""
