"""Numbers and docstrings as Markdown."""

from __future__ import annotations

import re
from collections.abc import Sequence
from inspect import cleandoc
from math import isclose

from flexarm.arm.vocabulary import KNOWN_EFFECTS

_EQUATION = re.compile(r"^\.\. math::(.*(?:\n(?:[ \t]+\S.*))*)", re.MULTILINE)
_NUMBER = re.compile(r"\s*\((\d+)\)\s*$")
_INLINE = re.compile(r"\\dot ?\\?[A-Za-z]+(?:_\w+)?|\\[A-Za-z]+(?:_\{?\w+\}?)?|\b[A-Za-z]_\w\b(?!\w)")
_REFERENCE = re.compile(r"\n\nReferences\n-+\n(.*)", re.DOTALL)
_METRES = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"))


def law(docstring: str) -> str:
    """A module's docstring: equations as GitHub shows them, symbols as formulas, effects as links."""
    body, references = cleandoc(docstring), ""
    if found := _REFERENCE.search(body):
        body = body[: found.start()]
        entries = re.sub(r"\n {3,}", " ", found[1].strip()).split("\n")
        references = "\n\n" + "\n".join("* " + re.sub(r"^\.\. ", "", line) for line in entries)
    pieces = _EQUATION.split(body)
    shown = [_equation(piece) if k % 2 else _prose(piece) for k, piece in enumerate(pieces)]
    return "".join(shown).strip() + references.replace("]_", "]")


def _equation(tex: str) -> str:
    one = " ".join(tex.split())
    number = _NUMBER.search(one)
    tag = rf" \tag{{{number[1]}}}" if number else ""
    return f"```math\n{_NUMBER.sub('', one)}{tag}\n```"


def _prose(text: str) -> str:
    """Symbols between dollars, names of other effects as links to their pages."""
    text = _INLINE.sub(lambda found: f"${found[0]}$", text.replace("]_", "]"))
    return re.sub(r"`(\w+)`", lambda f: f"[`{f[1]}`]({f[1]}.md)" if f[1] in KNOWN_EFFECTS else f[0], text)


def first_sentence(docstring: str) -> str:
    """What an effect is, in one line."""
    return " ".join(cleandoc(docstring).split("\n\n")[0].split())


def rounded(value: float) -> str:
    """Two significant digits, plain where that is short."""
    text = f"{value:.2g}"
    return f"{float(text):g}" if "e+" in text and abs(value) < 1e5 else text


def setting(value: float) -> str:
    """Four significant digits, for values of parameters: 0.996 is not 1."""
    return f"{float(f'{value:.4g}'):g}"


def metres(value: float) -> str:
    """A length with a unit that suits it."""
    factor, unit = length_unit(value)
    return f"{rounded(value / factor)} {unit}" if value else "0"


def length_unit(value: float) -> tuple[float, str]:
    """Factor and name of the unit in which a length is best told."""
    return next(((factor, unit) for factor, unit in _METRES if abs(value) >= factor), _METRES[-1])


def share(r2: float) -> str:
    """R^2 to three digits; what is not one is not told as one."""
    return "> 0.999" if r2 > 0.999 else f"{r2:.3f}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def percent(part: float) -> str:
    """A share of one."""
    return f"{100 * part:.0f} %"


def link(name: str) -> str:
    """A link to the page of an effect."""
    return f"[`{name}`]({name}.md)"


_FIGURE = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
CLOSE = 0.1
"""Greatest difference of two numbers of two digits whose last one differs by one."""


def same(old: str, new: str) -> bool:
    """Whether two texts agree: words exactly, numbers but for the last of their two or three digits."""
    if _FIGURE.sub("#", old) != _FIGURE.sub("#", new):
        return False
    pairs = zip(_FIGURE.findall(old), _FIGURE.findall(new), strict=True)
    return all(isclose(float(a), float(b), rel_tol=CLOSE, abs_tol=2e-3) for a, b in pairs)
