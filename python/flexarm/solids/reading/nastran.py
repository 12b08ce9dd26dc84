"""Nastran bulk data (.bdf, .nas, .fem, .dat).

Read are GRID, CTETRA, CHEXA, PSOLID with MAT1, and what names grids: SPC, SPC1, RBE2, RBE3, SET1, ASET1, and
SET of the case control. The cells of a property are a group `psolid-1`; sets of points are `spc-1`, `rbe2-7`
(its dependent grids), `rbe3-7` (the grids it averages), `set-3`, `aset`, `shell-4` (the grids of a shell's
property). GRDSET and the coordinate systems CORD1 and CORD2 hold for grids.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from flexarm.decks.cards import Card, cards
from flexarm.decks.coordinate_systems import Grids
from flexarm.errors import Problem
from flexarm.solids.reading.content import Block, Content, Elastic

_SOLIDS = {"CTETRA": (4, 10, "tetra"), "CHEXA": (8, 20, "hexahedron")}
_OTHER_SOLIDS = {"CPENTA": "wedge", "CPYRAM": "pyramid", "CPYRA": "pyramid"}
_SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 6, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 8}
#: Nastran's order of a hexahedron's middle nodes: bottom, upright, top; VTK's: bottom, top, upright.
_CHEXA = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]


def content(path: Path) -> Content:
    """Read the content of a bulk data file."""
    reader = _Reader()
    for card in cards(path):
        reader.take(card)
    return reader.finished(path)


_Span = list[range]
"""A range of grids, then those of its grids that EXCEPT takes out."""


class _Reader:
    def __init__(self) -> None:
        self.grids = Grids()
        self.cells: dict[str, list[tuple[int, int, list[int], Card]]] = {}
        self.properties: dict[int, Card] = {}
        self.materials: dict[int, Card] = {}
        self.sets: dict[str, list[_Span]] = {}
        self.left: dict[str, int] = {}
        self.steps: Mapping[str, Callable[[Card], None]] = {
            "GRID": self.grids.take,
            "GRDSET": self.grids.take,
            "PSOLID": lambda card: self.properties.update({card.integer(0): card}),
            "MAT1": lambda card: self.materials.update({card.integer(0): card}),
            "SPC": self._spc,
            "SPC1": lambda card: self._extend(f"spc-{card.integer(0)}", _range(card, 2)),
            "ASET1": lambda card: self._extend("aset", _range(card, 1)),
            "RBE2": self._rbe2,
            "RBE3": self._rbe3,
            "SET1": lambda card: self._extend(f"set-{card.text(0)}", _range(card, 1)),
            "SET": lambda card: self._extend(f"set-{card.text(0)}", _range(card, 1)),
        }

    def take(self, card: Card) -> None:
        """Read one card."""
        if card.name in _SOLIDS:
            self._solid(card)
        elif card.name in _SHELLS:
            count = _SHELLS[card.name]
            nodes = replace(card, fields=card.fields[2 : 2 + count])
            self._extend(f"shell-{card.integer(1, card.integer(0))}", _range(nodes, 0))
        elif card.name in _OTHER_SOLIDS:
            row = (card.integer(0), 0, [card.integer(2)], card)
            self.cells.setdefault(_OTHER_SOLIDS[card.name], []).append(row)
        elif card.name.startswith("CORD"):
            self.grids.take(card)
        elif card.name in self.steps:
            self.steps[card.name](card)
        elif card.name.startswith(("C", "RB", "MPC")) and card.text(0).isdecimal():
            self.left[card.name] = self.left.get(card.name, 0) + 1

    def _solid(self, card: Card) -> None:
        few, many, kind = _SOLIDS[card.name]
        texts = [text for text in card.fields[2:] if not text.startswith("+")]
        nodes = [_whole(card, text) for text in texts if text.isdecimal()]
        if len(nodes) not in (few, many) or len([t for t in texts[: len(nodes)] if t]) != len(nodes):
            raise card.error(
                f"cell {card.integer(0)} has {len(nodes)} nodes; allowed are {few}, or {many} without gaps"
            )
        if len(nodes) == 20:
            nodes = [nodes[i] for i in _CHEXA]
        kind = kind if len(nodes) == few else f"{kind}{many}"
        self.cells.setdefault(kind, []).append(
            (card.integer(0), card.integer(1, card.integer(0)), nodes, card)
        )

    def _spc(self, card: Card) -> None:
        """Read set, then grid, components, displacement, twice."""
        for i in (1, 4):
            self._extend(f"spc-{card.integer(0)}", _range(replace(card, fields=card.fields[i : i + 1]), 0))

    def _rbe2(self, card: Card) -> None:
        """Read number, independent grid, components, dependent grids, [thermal expansion]."""
        self._extend(f"rbe2-{card.integer(0)}", _range(card, 3))

    def _rbe3(self, card: Card) -> None:
        """Read number, blank, reference grid, components, then weight, components, grids, repeatedly."""
        grids, rest = [], iter(card.fields[4:])
        for text in rest:
            if text.upper() in ("UM", "ALPHA"):
                break
            if "." in text:
                next(rest, "")  # a weight and the components it is for
            else:
                grids.append(text)
        self._extend(f"rbe3-{card.integer(0)}", _range(replace(card, fields=grids), 0))

    def _extend(self, name: str, grids: Iterable[_Span]) -> None:
        self.sets.setdefault(name, []).extend(grids)

    def finished(self, path: Path) -> Content:
        """Return all that was read."""
        index = {number: i for i, number in enumerate(self.grids.cards)}
        points = [self.grids.position(number) for number in index]
        found = Content(
            points=np.array(points, float).reshape(-1, 3),
            numbers=np.array(list(index), int),
            blocks=[self._block(kind, rows, index) for kind, rows in self.cells.items()],
        )
        for i, rows in enumerate(self.cells.values()):
            owners = np.array([owner for _, owner, _, _ in rows])
            for owner in np.unique(owners):
                found.groups.setdefault(f"psolid-{owner}", {})[i] = np.flatnonzero(owners == owner)
        for name, spans in self.sets.items():
            there = np.array([index[grid] for span in spans for grid in _common(span, index)], int)
            if len(there):  # a set of the case control may also number cells
                found.point_sets[name] = there
        found.materials = self._elastic()
        found.notes = [Problem("cells", f"{n} cards {name} are not read") for name, n in self.left.items()]
        return found

    def _block(
        self, kind: str, rows: list[tuple[int, int, list[int], Card]], index: Mapping[int, int]
    ) -> Block:
        for _, _, grids, card in rows:
            missing = [grid for grid in grids if grid not in index]
            if missing:
                raise card.error(f"names grid {missing[0]}, which is not in the file")
        nodes = np.array([[index[grid] for grid in grids] for _, _, grids, _ in rows])
        return Block(kind, nodes, np.array([number for number, _, _, _ in rows]))

    def _elastic(self) -> dict[str, Elastic]:
        found = {}
        for number, card in self.properties.items():
            material = self.materials.get(card.integer(1, 0))
            if material is None:
                self.left["PSOLID without MAT1"] = self.left.get("PSOLID without MAT1", 0) + 1
                continue
            found[f"psolid-{number}"] = _mat1(material)
        return found


def _common(span: _Span, grids: Mapping[int, int]) -> Iterable[int]:
    """Return the grids of a range that exist; ranges such as `1 THRU 99999999` are common."""
    whole, *without = span
    there = [n for n in whole if n in grids] if len(whole) < len(grids) else [n for n in grids if n in whole]
    return [n for n in there if not any(n in left_out for left_out in without)]


def _whole(card: Card, text: str) -> int:
    return Card(card.name, [text], card.file, card.line).integer(0)


def _mat1(card: Card) -> Elastic:
    """Read number, E, G, nu, rho; of E, G, nu one may be left out: E = 2 G (1 + nu)."""
    modulus, shear, ratio = (card.number(i) if card.text(i) else None for i in (1, 2, 3))
    if modulus is None and shear is not None and ratio is not None:
        modulus = 2 * shear * (1 + ratio)
    if ratio is None and modulus is not None and shear:
        ratio = modulus / (2 * shear) - 1
    density = card.number(4) if card.text(4) else None
    return Elastic(f"line {card.line}, MAT1 {card.text(0)}", modulus, ratio, density)


def _range(card: Card, first: int) -> list[_Span]:
    """Read grids from a field on: numbers, and `a THRU b` [`BY` step] [`EXCEPT` numbers].

    EXCEPT ends at the first number outside its range. Source: MSC Nastran Quick Reference Guide, SET.
    """
    texts = [text.upper() for text in card.fields[first:] if text and not text.startswith("+")]
    found: list[_Span] = []
    except_these = False
    rest = iter(texts)
    for text in rest:
        if text == "THRU" and found:
            last = _whole(card, next(rest, ""))
            found[-1].append(range(found[-1].pop().start, last + 1))
        elif text == "BY" and found:
            step = _whole(card, next(rest, ""))
            if step < 1:
                raise card.error(f"BY needs a positive step, got {step}")
            span = found[-1].pop()
            found[-1].append(range(span.start, span.stop, step))
        elif text == "EXCEPT" and found:
            except_these = True
        elif text.isdecimal():
            number = _whole(card, text)
            except_these = except_these and number in found[-1][0]
            if not except_these:
                found.append([])
            found[-1].append(range(number, number + 1))
        elif text != "ALL" and "." not in text:
            raise card.error(f"must be grids or THRU, got {text!r}")
    return found
