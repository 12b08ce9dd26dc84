"""A model, virtual records of it and a mesh to try the commands on: what `flexarm example` writes."""
