"""Moves of the search: proposals of larger models."""
