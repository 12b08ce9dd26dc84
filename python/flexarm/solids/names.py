"""Names that a mesh has, for a user who asked for another."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def known_names(name: str, known: Iterable[str], none: str) -> str:
    """List the names there are, close ones first."""
    names = list(known)
    if not names:
        return none
    folded = {other.casefold(): other for other in names}
    close = [folded[match] for match in get_close_matches(name.casefold(), folded, n=3, cutoff=0.6)]
    meant = f" (did you mean {' or '.join(map(repr, close))}?)" if close else ""
    shown = ", ".join(names[:40]) + (f" and {len(names) - 40} more" if len(names) > 40 else "")
    return f"there are {shown}{meant}"
