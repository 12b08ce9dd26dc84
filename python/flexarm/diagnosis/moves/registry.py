"""Moves of the search by name, in the order in which a step makes them."""

from __future__ import annotations

from collections.abc import Mapping

from flexarm.diagnosis.moves.confounding import confounding
from flexarm.diagnosis.moves.families import families
from flexarm.diagnosis.moves.proposals import pairs, singles, triples
from flexarm.diagnosis.moves.search_state import Move
from flexarm.diagnosis.moves.shapes import shapes
from flexarm.diagnosis.moves.springs import spring_swap, twin_spring

FORWARD: Mapping[str, Move] = {
    "singles": singles,
    "families": families,
    "twin_spring": twin_spring,
    "confounding": confounding,
}
"""They add an effect."""
CONFLICT: Mapping[str, Move] = {
    "confounding": confounding,
    "singles": singles,
    "families": families,
    "twin_spring": twin_spring,
}
"""The same where nothing but a conflict with priors is left."""
SETS: Mapping[str, Move] = {"pairs": pairs, "triples": triples}
"""They compete with a single effect, which is the model that they get."""
ELSEWHERE: Mapping[str, Move] = {"spring_swap": spring_swap}
"""They change the best model."""
SHAPES: Mapping[str, Move] = {"shapes": shapes}
"""They free the shape of one of its laws."""
