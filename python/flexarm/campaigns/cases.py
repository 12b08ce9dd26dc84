"""Cases of a study: the drives or records that every variant of the model runs through.

A word in braces, as in `fleet/{machine}/{date}/slow`, stands for any one folder or part of its name. Each
combination that is there is a case, and the words are its labels.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from glob import escape
from pathlib import Path

from flexarm.campaigns.study import Found, Study

_WORD = re.compile(r"\{([A-Za-z_]\w*)\}")


@dataclass(frozen=True)
class Case:
    """One case."""

    labels: Mapping[str, str]
    """Words that stood in braces, or the name of the drive where there are several."""
    files: tuple[Path, ...] = ()
    """Drive, or records in their order."""
    hold_out: Path | None = None
    """The record that is held out."""


def cases_of(study: Study, folder: Path) -> tuple[tuple[Case, ...], Found]:
    """Return the cases of a study that lies in a folder, and what is wrong with them."""
    if study.run in ("static", "modes"):
        return (Case({}),), []
    if study.run == "diagnose":
        return _record_cases(study, folder)
    found: Found = []
    cases: list[Case] = []
    for i, pattern in enumerate(study.drive):
        there = matches(folder, pattern)
        if not there:
            found.append((("drive", i) if len(study.drive) > 1 else ("drive",), _nothing(folder, pattern)))
        cases += [Case(labels, (path,)) for labels, path in there]
    alike = len({tuple(case.labels.items()) for case in cases}) < len(cases)
    if len(cases) > 1 and (alike or not all(case.labels for case in cases)):
        cases = [
            Case({**case.labels, "drive": str(case.files[0].relative_to(folder))}, case.files)
            for case in cases
        ]
    return tuple(cases), found


def _record_cases(study: Study, folder: Path) -> tuple[tuple[Case, ...], Found]:
    found: Found = []
    words = set(_WORD.findall(study.records[0]))
    for place, pattern in [
        *((("records", i), each) for i, each in enumerate(study.records)),
        *([(("hold_out",), study.hold_out)] if study.hold_out else []),
    ]:
        if unknown := set(_WORD.findall(pattern)) - words:
            known = ", ".join(sorted(words)) or "none"
            what = f"has {{{min(unknown)}}}, which the first of records has not; it has {known}"
            found.append((place, what))
        elif not words and not (folder / pattern).exists():
            found.append((place, _nothing(folder, pattern)))
    found_paths = matches(folder, study.records[0])
    there = [each for each in found_paths if each[1].is_dir() or each[1].suffix == ".toml"]
    if words and not there:
        found.append((("records", 0), _nothing(folder, study.records[0])))
    cases = [
        Case(
            labels,
            tuple(folder / _filled(each, labels) for each in study.records),
            folder / _filled(study.hold_out, labels) if study.hold_out else None,
        )
        for labels, _ in there
    ]
    return tuple(cases), found


def matches(folder: Path, pattern: str) -> list[tuple[dict[str, str], Path]]:
    """Return paths that a pattern means, sorted, each with the words in its braces."""
    parts = _WORD.split(pattern)  # text, word, text, word, ..., text
    if len(parts) == 1:
        path = folder / pattern
        return [({}, path)] if path.exists() else []
    glob, regex, seen = "", "", set[str]()
    for i, part in enumerate(parts):
        if i % 2:
            glob += "*"
            regex += f"(?P={part})" if part in seen else f"(?P<{part}>[^/]+)"
            seen.add(part)
        else:
            glob += escape(part)
            regex += re.escape(part)
    found = []
    for path in sorted(folder.glob(glob)):
        if match := re.fullmatch(regex, path.relative_to(folder).as_posix()):
            found.append((match.groupdict(), path))
    return found


def _filled(pattern: str, labels: Mapping[str, str]) -> str:
    return _WORD.sub(lambda match: labels[match[1]], pattern)


def _nothing(folder: Path, pattern: str) -> str:
    return f"there is no {folder / pattern}"


def label_names(cases: Sequence[Case]) -> tuple[str, ...]:
    """Return the names of the labels of all cases."""
    return tuple(dict.fromkeys(name for case in cases for name in case.labels))
