"""The example that `flexarm example` writes: a model, virtual records of it and a mesh."""
