"""A record: signals with their clocks and frames, measured or simulated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arguments import BASE, NAME_OR_NAMES, NAMED, NAMES, SIGNALS, holds, takes
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.output import output_directory, output_file
from flexarm.pictures import Shown
from flexarm.record.signal import Signal
from flexarm.record.table import BaseStand, CarriedPayload, Clock, DrawnLink, Frame
from flexarm.tables import FrozenDict

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from flexarm.arm.arm import Arm


KINDS = ("motion", "static", "frequency_response")
INITIAL = ("equilibrium", "moving")


@holds(signals=SIGNALS, drive=NAME_OR_NAMES, payloads=NAMED, controllers=NAMED, links=NAMED, base=BASE)
@dataclass(frozen=True, kw_only=True)
class Record(Shown):
    """Signals of one run, or of a set of static poses.

    Attributes
    ----------
    signals : dict of str to Signal, or iterable of Signal
        Each on its own instants; stored as a dictionary.
    drive : tuple of str
        Signals that drive a simulation; empty: nothing moves.
    description, kind, initial : str
        `kind` is "motion", "static" (poses) or "frequency_response", `initial` "equilibrium" or "moving".
    joints : dict of str to float
        Where joints stand that nothing drives [rad or m].
    payloads : dict of str to CarriedPayload
        What this run carried, where it differs from the model.
    controllers : dict of str to dict of str to float
        Of the controllers of joints the values, such as gains, that were others in this run.
    links : dict of str to DrawnLink
        Lengths of beams that are drawn out as far as a run needs them.
    clocks : dict of str to Clock
        The first one is the reference.
    frames : dict of str to Frame
        Frames of measurement; "base" is always there.
    base : BaseStand or None
        How the base stood in this run, if that was measured.
    path : Path or None
        The directory it was read from; not compared.
    notes : tuple of Problem
        What reading it found strange; not compared.
    """

    signals: Mapping[str, Signal]
    drive: tuple[str, ...] = ()
    description: str = ""
    kind: str = "motion"
    initial: str = "equilibrium"
    joints: Mapping[str, float] = field(default_factory=FrozenDict)
    payloads: Mapping[str, CarriedPayload] = field(default_factory=FrozenDict)
    controllers: Mapping[str, Mapping[str, float]] = field(default_factory=FrozenDict)
    links: Mapping[str, DrawnLink] = field(default_factory=FrozenDict)
    clocks: Mapping[str, Clock] = field(default_factory=FrozenDict)
    frames: Mapping[str, Frame] = field(default_factory=FrozenDict)
    base: BaseStand | None = None
    path: Path | None = field(default=None, compare=False)
    notes: tuple[Problem, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        given: Any = self.signals
        signals: Iterable[Signal] = given.values() if isinstance(given, Mapping) else given
        clocks = self.clocks or {"clock": Clock()}
        reference = next(iter(clocks))
        named = FrozenDict({s.name: s if s.clock else s.replace(clock=reference) for s in signals})
        drives: Any = self.drive
        drive = (drives,) if isinstance(drives, str) else tuple(drives)
        for name, value in (("signals", named), ("drive", drive), ("clocks", FrozenDict(clocks))):
            object.__setattr__(self, name, value)
        for name in ("joints", "payloads", "controllers", "links", "frames"):
            object.__setattr__(self, name, FrozenDict(getattr(self, name)))
        self._check_names()

    def _check_names(self) -> None:
        for key, allowed in (("kind", KINDS), ("initial", INITIAL)):
            if (value := getattr(self, key)) not in allowed:
                raise InvalidParameter(f"must be {' or '.join(allowed)}, got {value!r}", where=key)
        for name in self.drive:
            if name not in self.signals:
                raise InvalidParameter(missing("signal", name, self.signals), where="drive")
        for signal in self.signals.values():
            if signal.input and signal.input not in self.signals:
                raise InvalidParameter(
                    missing("signal", signal.input, self.signals), where=f"signals.{signal.name}.input"
                )
            if signal.clock not in self.clocks:
                raise InvalidParameter(
                    missing("clock", signal.clock, self.clocks), where=f"signals.{signal.name}.clock"
                )
            if signal.frame not in ("base", *self.frames):
                raise InvalidParameter(
                    missing("frame", signal.frame, ["base", *self.frames]),
                    where=f"signals.{signal.name}.frame",
                )

    # ------------------------------------------------------------------ files

    @classmethod
    @takes()
    def load(cls, path: str | Path, *, allow_outside: bool = False) -> Record:
        """Return the record in a directory.

        Parameters
        ----------
        path : str or Path
            The directory that holds `record.toml`, or that file.
        allow_outside : bool
            Read files that lie outside this directory, too.

        Raises
        ------
        InvalidFile
            With the place and value of what is wrong.
        """
        from flexarm.record.load import stored

        return cls(**stored(Path(path), allow_outside))

    @takes()
    def save(self, path: str | Path, force: bool = False) -> None:
        """Write `record.toml` and the CSV files, in SI; `Record.load` of it gives the same values.

        Parameters
        ----------
        path : str or Path
            A new or empty directory.
        force : bool
            Write into a directory that holds files, but not over those that the record was read from.

        Raises
        ------
        InvalidFile
            If the directory holds files, or cannot be written.
        """
        from flexarm.record.save import write

        with output_directory(path, force, self.files, ["record.toml"]) as directory:
            write(self, directory)

    def to_pandas(self) -> pd.DataFrame:
        """Return the signals as one table.

        Returns
        -------
        DataFrame
            In SI: columns named after signals and axes, such as `hinge` and `tip_x`; rows by `time_s`, each
            signal on its own clock and instants, NaN where it has no sample. Of poses the rows go by `pose`
            and the number of the `reading` within it. `attrs["units"]` has the units.
        """
        from flexarm.record.data_frame import data_frame

        return data_frame(self)

    @takes()
    def to_parquet(self, path: str | Path) -> None:
        """Write the table of `to_pandas` as a Parquet file, which the extra `import` installs Arrow for.

        Raises
        ------
        InvalidFile
            If Arrow is missing, or the file cannot be written.
        """
        if find_spec("pyarrow") is None:
            raise InvalidFile(path, "output", "needs the package pyarrow: pip install 'flexarm[import]'")
        with output_file(path, self.files) as partial:
            self.to_pandas().to_parquet(partial)

    @takes(signals=NAMES)
    def plot(self, signals: Iterable[str] | None = None) -> Figure:
        """Draw signals against time, a panel each; of poses against the pose, of responses their size.

        Parameters
        ----------
        signals : iterable of str, optional
            Their names; default: all. Instants are those of the reference clock.

        Raises
        ------
        InvalidParameter
            If there is no such signal, or none has values.
        """
        from flexarm.record.picture import figure_of

        return figure_of(self, None if signals is None else list(signals))

    # ------------------------------------------------------------------- parts

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that it was read from; none if it was made otherwise."""
        if self.path is None:
            return ()
        names = dict.fromkeys(["record.toml", *(s.file for s in self.signals.values() if s.file)])
        return tuple(self.path / name for name in names)

    @property
    def reference_clock(self) -> str:
        """Name of the clock that the others are measured against."""
        return next(iter(self.clocks))

    def frame_of(self, signal: Signal) -> Frame:
        """Return the frame of a signal; the base's own is exact."""
        return self.frames.get(signal.frame, Frame())

    def instants(self, signal: Signal) -> Floats:
        """Return the stamps of a signal less how late its clock is stated to be [s], shape (n,)."""
        return signal.time - self.clocks[signal.clock].offset

    @property
    def poses(self) -> tuple[str, ...]:
        """Poses of a static record, in the order in which they appear."""
        return tuple(
            dict.fromkeys(str(p) for s in self.signals.values() if s.pose is not None for p in s.pose)
        )

    def of_quantity(self, quantity: str) -> dict[str, Signal]:
        """Return the signals of one quantity."""
        return {name: signal for name, signal in self.signals.items() if signal.quantity == quantity}

    def replace(self, **changes: Any) -> Record:
        """Return a changed copy."""
        return replace(self, **changes)

    @takes()
    def check(self, arm: Arm | None = None) -> list[Problem]:
        """Return implausible values of the record: units, dead channels, gaps.

        Parameters
        ----------
        arm : Arm, optional
            Whose gears turn shafts of motors more often than joints turn.
        """
        from flexarm.record.plausibility import validate

        return [*self.notes, *validate(self, arm)]

    @takes()
    def check_against(self, arm: Arm) -> list[Problem]:
        """Return values that do not fit a model.

        Parameters
        ----------
        arm : Arm
            The model.

        Returns
        -------
        list of Problem
            Values that look wrong for this arm, such as positions far beyond its reach.

        Raises
        ------
        InvalidParameter
            If the record names joints, points, links or payloads that the model has not, or its other signals
            tell of a motion while its drive is unknown; an `InvalidFile` if it was read from a file.
        """
        from flexarm.record.compatibility import unknown_names, validate
        from flexarm.record.plausibility import unknown_motion

        if problems := unknown_names(self, arm) or unknown_motion(self):
            raise self._error(problems)
        return validate(self, arm)

    @takes()
    def with_units_of(self, arm: Arm) -> Record:
        """Return the record with the units of a model's joints, where it states none.

        Parameters
        ----------
        arm : Arm
            The model; its joints that slide have metres and newtons.

        Returns
        -------
        Record
            With the same numbers.
        """
        from flexarm.record.compatibility import with_units_of

        return with_units_of(self, arm)

    @takes()
    def applied_to(self, arm: Arm) -> Arm:
        """Return the arm with the payloads, link lengths, controllers and tilt of the base of this run.

        Parameters
        ----------
        arm : Arm
            The model.

        Returns
        -------
        Arm
            With weighed masses and a measured tilt in place of the model's; effects `payload_mass` and
            `base_tilt` give way to them.
        """
        from flexarm.record.compatibility import with_overrides

        return with_overrides(self, arm)

    def _error(self, problems: list[Problem]) -> InvalidParameter:
        first = problems[0]
        if self.path is None:
            return InvalidParameter(first.what, where=first.where, problems=tuple(problems))
        return InvalidFile(self.path / "record.toml", first.where, first.what, problems=tuple(problems))

    def summary(self) -> str:
        """Return the record in a line, and each of its signals in another."""
        return "\n".join([repr(self), *(f"  {signal!r}" for signal in self.signals.values())])

    def __repr__(self) -> str:
        what = f"{len(self.poses)} poses" if self.kind == "static" else f"{self.duration:.6g} s"
        what = "frequency responses" if self.kind == "frequency_response" else what
        label = f" {self.description!r}" if self.description else ""
        return f"<Record{label}: {what}, signals {', '.join(self.signals)}>"

    @property
    def duration(self) -> float:
        """Duration of the motion [s]: of the longest drive, or of the longest signal if nothing drives."""
        drives = [self.signals[name] for name in self.drive]
        spans = [
            float(signal.time[-1] - signal.time[0])
            for signal in drives or self.signals.values()
            if len(signal.time)
        ]
        return max(spans, default=0.0)
