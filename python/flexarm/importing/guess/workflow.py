"""A map proposed from names, rates, ranges and the model's motion.

    1. names     what each column is, of which joint or point                       (`words`)
    2. stamps    the column that rises, its unit by name or size                    (`logged`)
    3. units     of angles those for which the model's points move as far as measured (`motion`)
    4. signs     and counts per turn, with which the model comes nearest to a point  (`signs`)
    5. clocks    one a file, frames known where the coordinates are the base's

What none of this tells is written as `# unknown:`, and a signal that cannot be read so is commented out.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from flexarm.arguments import ITEMS, takes
from flexarm.arm import Arm
from flexarm.importing.guess.logged import logged
from flexarm.importing.guess.poses import as_poses
from flexarm.importing.guess.proposal import Proposal, drives_of
from flexarm.importing.guess.settled import settle_motion, settle_noise, settle_units
from flexarm.importing.guess.signals import (
    joint_signals,
    named_after_joints,
    of_joint_type,
    point_signals,
    settle_doubles,
    settle_places,
    unnamed_points,
)
from flexarm.importing.guess.signs import settle_signs
from flexarm.importing.guess.text import map_text
from flexarm.importing.guess.vectors import named_by_direction, with_quaternions, with_rotations


@takes(files=ITEMS)
def guess_map(files: Iterable[Path], model: str | Path, out: str | Path) -> str:
    """Return the text of an import map, TOML, that is proposed for the logs of one run and a model.

    A reason stands beside each line; `# unknown: ...` marks what the logs do not tell. `out` is where the map
    shall lie: its sources are named from there. Raise InvalidFile if a log cannot be read.
    """
    arm = Arm.from_toml(model)
    folder = Path(out).absolute().parent
    columns = [
        column
        for path in map(Path, files)
        for column in logged(path, os.path.relpath(path.absolute(), folder).replace(os.sep, "/"))
    ]
    columns = with_rotations(with_quaternions(named_by_direction(columns)))
    columns = as_poses(named_after_joints(columns, arm))
    stamped = [c for c in columns if c.time.column is not None or c.time.poses] or columns
    proposals = [*joint_signals(stamped, arm), *point_signals(stamped, arm)]
    settle_places(proposals, arm)
    proposals = [proposal for proposal in proposals if of_joint_type(proposal, arm)]
    proposals.sort(key=lambda p: p.place[0] == "point" and p.quantity == "position" and not p.moves())
    settle_doubles(proposals)
    proposals += unnamed_points(stamped, proposals, arm)
    settle_units(proposals, arm)
    settle_signs(proposals, arm)
    frames = settle_motion(proposals, arm)
    settle_noise(proposals, arm)
    settle_names(proposals)
    used = {id(column) for proposal in proposals for column in proposal.columns}
    left = [column for column in columns if id(column) not in used]
    named = os.path.relpath(Path(model).absolute(), folder).replace(os.sep, "/")
    return map_text(named, drives_of(proposals), proposals, left, frames)


def settle_names(proposals: Sequence[Proposal]) -> None:
    """Name signals after their places, further ones of a place after what they are."""
    taken: set[str] = set()
    for proposal in proposals:
        place = proposal.place[1] or "unknown"
        plain = {"joint_angle": "", "position": ""}.get(proposal.quantity, f"_{proposal.quantity}")
        side = "_output" if proposal.keys.get("side") == "output" and not plain else ""
        name = base = f"{place}{plain}{side}"
        number = 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        taken.add(name)
        proposal.name = name
