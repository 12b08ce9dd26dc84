"""The state of an arm between two steps: a value."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, SupportsIndex, SupportsInt

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arguments import takes
from flexarm.arrays import Floats, frozen
from flexarm.errors import InvalidFile
from flexarm.output import write_file
from flexarm.reading import reading, regular_file, room

FORMAT = "flexarm-state/1"


@dataclass(frozen=True, eq=False)
class Stored:
    """A moment of the core as plain numbers."""

    state: dict[str, Floats]
    factored: dict[str, Floats]
    """Arrays of the state, and of the one at which the kept matrix was factored (empty: none yet)."""
    forces: dict[int, Floats]
    """Forces at points that were part of that matrix [N]."""
    counts: tuple[int, int, float, float]
    """Steps since the start, accepted steps, contraction of Newton's iteration, step of that matrix [s]."""

    @classmethod
    def of(cls, moment: _core.Moment) -> Stored:
        """Return the numbers of a moment."""
        return cls(
            {name: frozen(array) for name, array in moment.arrays().items()},
            {name: frozen(array) for name, array in moment.factored_arrays().items()},
            {point: frozen(force) for point, force in moment.factored_forces().items()},
            moment.counts(),
        )

    def moment(self, system: _core.System) -> _core.Moment:
        """Return the moment of these numbers."""
        forces: dict[SupportsInt | SupportsIndex, ArrayLike] = {}
        forces.update((point, force) for point, force in self.forces.items())
        return _core.moment(system, self.state, self.factored, forces, self.counts)

    def flat(self) -> dict[str, Any]:
        """Return the same under one name each, as a file holds them."""
        return {
            **{f"state.{name}": array for name, array in self.state.items()},
            **{f"factored.{name}": array for name, array in self.factored.items()},
            **{f"forces.{point}": array for point, array in self.forces.items()},
            "counts": np.array(self.counts[:2], dtype=np.int64),
            "iteration": np.array(self.counts[2:]),
        }

    @classmethod
    def from_flat(cls, flat: dict[str, Any]) -> Stored:
        """Return the numbers that `flat` made."""

        def group(prefix: str) -> dict[str, Floats]:
            begin = f"{prefix}."
            return {name[len(begin) :]: frozen(a) for name, a in flat.items() if name.startswith(begin)}

        steps, accepted = (int(count) for count in flat["counts"])
        contraction, h = (float(value) for value in flat["iteration"])
        forces = {int(point): force for point, force in group("forces").items()}
        return cls(group("state"), group("factored"), forces, (steps, accepted, contraction, h))


class State:
    """An arm at one instant, with what the solver carries to the next step: a value that nobody changes.

    Made by `Stepper.start` and `Stepper.step`, read through the `Stepper`. Copies, pickles and files go on
    to the same bits. Two states are equal if all their numbers are, the solver's included.
    """

    __slots__ = ("_key", "_moment", "_stored")

    def __init__(self, key: str, moment: _core.Moment | None, stored: Stored | None = None) -> None:
        self._key = key
        self._moment = moment
        self._stored = stored

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        if self._moment is not None:
            return self._moment.time
        return float(self.stored.state["time"][0, 0])

    @property
    def key(self) -> str:
        """Hash of the model and of what its joints are told; a `Stepper` takes states of its own key."""
        return self._key

    @property
    def stored(self) -> Stored:
        """The state as plain numbers."""
        if self._stored is None:
            assert self._moment is not None
            self._stored = Stored.of(self._moment)
        return self._stored

    def moment(self, system: _core.System) -> _core.Moment:
        """Return the state as the core has it."""
        if self._moment is None:
            self._moment = self.stored.moment(system)
        return self._moment

    @takes()
    def save(self, path: str | Path) -> None:
        """Write the state as an .npz file, whatever its name.

        Raises
        ------
        InvalidFile
            If the file cannot be written.
        """
        image = BytesIO()
        np.savez(image, format=FORMAT, key=self._key, **self.stored.flat())
        write_file(path, image.getbuffer())

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> State:
        """Read what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is missing or holds no state.
        """
        with reading(regular_file(path), "a stored state"), zipfile.ZipFile(path) as packed:
            room(path, "file", sum(entry.file_size for entry in packed.infolist()))
            with np.load(path, allow_pickle=False) as file:
                flat = {name: file[name] for name in file.files}
            if str(flat.pop("format", "")) != FORMAT:
                raise InvalidFile(path, "format", f"is no stored state; needed is {FORMAT!r}")
            return cls(str(flat.pop("key")), None, Stored.from_flat(flat))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        if self is other:
            return True
        mine, theirs = self.stored.flat(), other.stored.flat()
        return (
            self._key == other._key
            and mine.keys() == theirs.keys()
            and all(np.array_equal(mine[name], theirs[name]) for name in mine)
        )

    def __hash__(self) -> int:
        return hash((self._key, self.time))

    def __copy__(self) -> State:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> State:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return State, (self._key, None, self.stored)

    def __repr__(self) -> str:
        return f"<State at {self.time:g} s>"


class JointReading(NamedTuple):
    """A joint at an instant."""

    angle: float
    rate: float
    """Angle theta of the link about the joint [rad], and its rate [rad/s]; [m], [m/s] if prismatic."""
    drive_angle: float
    drive_rate: float
    """Angle phi of the motor over the gear ratio, and its rate, in the same units."""
    torque: float
    motor_torque: float
    """On the child about +axis, and of the motor with rotor inertia and friction; output-referred [N m; N if
    prismatic]."""


class PointReading(NamedTuple):
    """A point at an instant."""

    position: Floats
    velocity: Floats
    acceleration: Floats
    """Base axes [m], [m/s], [m/s2], shape (3,)."""
    rotation: Floats
    """Body axes as columns, base axes, shape (3, 3)."""
    angular_rate: Floats
    """Body axes [rad/s], shape (3,)."""
