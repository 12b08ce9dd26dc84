"""Write docs/effects: a page and a picture for each effect, an index, and who is confused with whom.

--only NAME writes one page; --check writes nothing and tells which pages differ, in words or by more than one
unit of a number's last digit.
"""

import argparse
import sys
from pathlib import Path

from gallery.confusion import Study, study
from gallery.contents import index
from gallery.pages import page
from gallery.picture import draw_confusion, draw_gap
from gallery.signatures import names
from gallery.text import same

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "effects"


def texts(found: Study, only: str | None = None) -> dict[str, str]:
    """What belongs into each file."""
    pages = {f"{name}.md": page(name, found) for name in found.signatures if only in (None, name)}
    return pages if only else {**pages, "README.md": index(found)}


def draw(found: Study, only: str | None = None) -> None:
    """The pictures of these files."""
    for name, signature in found.signatures.items():
        if only in (None, name):
            draw_gap(signature, FOLDER / f"{name}.png")
    if only is None:
        draw_confusion(found.poor, "Poor: the tip in a slow sine, one payload", FOLDER / "confusion-poor.png")
        title = "Rich: all sensors in the faster motion, two payloads"
        draw_confusion(found.rich, title, FOLDER / "confusion-rich.png")


def stale(expected: dict[str, str]) -> list[str]:
    """Files that are missing or differ from what is expected."""
    paths = {FOLDER / file: text for file, text in expected.items()}
    old = {path: path.read_text(encoding="utf-8") if path.exists() else "" for path in paths}
    return [path.name for path, text in paths.items() if not same(old[path], text)]


def main() -> int:
    """Exit code 1 if --check finds a page out of date."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", metavar="NAME", choices=names())
    parser.add_argument("--check", action="store_true")
    asked = parser.parse_args()
    found = study(names())
    expected = texts(found, asked.only)
    if asked.check:
        for file in stale(expected):
            print(f"docs/effects/{file} is out of date: python scripts/effects_gallery.py")
        return int(bool(stale(expected)))
    FOLDER.mkdir(exist_ok=True)
    for file, text in expected.items():
        (FOLDER / file).write_text(text, encoding="utf-8")
    draw(found, asked.only)
    return 0


if __name__ == "__main__":
    sys.exit(main())
