"""The values of --interface: where a part is joined."""

from __future__ import annotations

from flexarm.errors import InvalidFile


def read_interfaces(interface: list[str] | None, form: str) -> dict[str, str]:
    """Return WHAT by NAME of every --interface NAME=WHAT.

    Raises
    ------
    InvalidFile
        If one is not of the form, has a bad name, or a name stands twice.
    """
    from flexarm.tables.table import check_name

    pairs: dict[str, str] = {}
    for text in interface or ():
        name, equals, what = (part.strip() for part in text.partition("="))
        if not equals or not name or not what:
            raise InvalidFile("command line", "--interface", f"must be {form}, got {text!r}")
        try:
            check_name(name)
        except ValueError as error:
            raise InvalidFile("command line", "--interface", f"{name!r}: {error}") from None
        if name in pairs:
            raise InvalidFile("command line", "--interface", f"{name!r} is given twice")
        pairs[name] = what
    return pairs
