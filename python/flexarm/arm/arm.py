"""The arm: joints, links, what they carry, what is seen, and the effects that act in it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, SerializeAsAny, model_validator

from flexarm.arguments import NUMBER, TABLES, takes
from flexarm.arm.attachment import Payload, Point
from flexarm.arm.closure import Closure
from flexarm.arm.consistency import inconsistencies, missing
from flexarm.arm.controller import Controller
from flexarm.arm.crossed_hinges import with_hinges
from flexarm.arm.effect import Effect, read_effect
from flexarm.arm.joint import Gear, Joint
from flexarm.arm.link import Link
from flexarm.arm.motor import Motor
from flexarm.arm.part_files import found_from, part_problems, seen_from
from flexarm.arm.plausibility import validate
from flexarm.arm.sensor import Sensor
from flexarm.arm.uncertainty import flat_keys, sigma_of, uncertainty_problems
from flexarm.arm.urdf import with_urdf
from flexarm.errors import InvalidParameter, Problem
from flexarm.output import place_of, write_file
from flexarm.pictures import Shown, drawn, viewed
from flexarm.tables import (
    FrozenDict,
    Inconsistent,
    Name,
    Number,
    Table,
    Vector3,
    check_table,
    read_toml,
    refuse,
    toml_text,
    value_in,
)
from flexarm.tables.edited import edited_toml
from flexarm.tables.table import Label
from flexarm.tables.toml import read_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.viewer import View

Entry = TypeVar("Entry", Joint, Link, Payload, Point)
AnyEffect = Annotated[SerializeAsAny[Effect], BeforeValidator(read_effect)]
Sigmas = Annotated[dict[str, Number], BeforeValidator(flat_keys), AfterValidator(FrozenDict)]


def _last_of_each(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """Return the effects, the last of those with one name and place."""
    return tuple({(effect.name, effect.at): effect for effect in effects}.values())


class Arm(Shown, Table):
    """A flexible arm, frozen: the tables of a model file, checked.

    Parameters
    ----------
    name : str
        Name of the arm.
    gravity : (3,)
        Acceleration of gravity in the base's axes [m/s2].
    joints, gears, links, payloads, points, closures, sensors, motors, controllers, effects : tuple
        The tables of the same names, in the order of the file.
    assembly : dict of str to float
        Where joints stand when loops are closed first [rad, m].
    encoders : dict of str to str
        Joints of the encoders in records, by the names of their signals.
    uncertainty : dict
        1 sigma of nominal values; see `sigma`.

    Examples
    --------
    >>> arm = Arm.from_toml("arm.toml")  # doctest: +SKIP
    >>> softer = arm.with_effect(JointCompliance(at="hinge", stiffness=5e4))  # doctest: +SKIP
    """

    format: Literal["flexarm-arm/1"] = "flexarm-arm/1"
    name: Label = Field("arm", description="name of the arm", min_length=1)
    gravity: Vector3 = value_in("m/s2", "acceleration of gravity in the base's axes", (0.0, 0.0, -9.81))
    urdf: str | None = None
    joints: tuple[Joint, ...] = ()
    gears: tuple[Gear, ...] = ()
    links: tuple[Link, ...] = ()
    payloads: tuple[Payload, ...] = ()
    points: tuple[Point, ...] = ()
    closures: tuple[Closure, ...] = ()
    assembly: Annotated[dict[str, Number], AfterValidator(FrozenDict)] = FrozenDict()
    sensors: tuple[Sensor, ...] = ()
    encoders: Annotated[dict[str, Name], AfterValidator(FrozenDict)] = FrozenDict()
    motors: tuple[Motor, ...] = ()
    controllers: tuple[Controller, ...] = ()
    effects: Annotated[tuple[AnyEffect, ...], AfterValidator(_last_of_each)] = ()
    uncertainty: Sigmas = FrozenDict()

    @model_validator(mode="after")
    def _check(self) -> Self:
        found = inconsistencies(self)
        if self.urdf is not None:
            found = [(("urdf",), "is read by Arm.from_toml and Arm.from_dict; an Arm made here has none")]
        if not self.joints:
            found = [(("joints",), "is missing; a model needs at least one joint and one link"), *found]
        found += [] if found else uncertainty_problems(self)
        if found:
            raise Inconsistent(*found)
        return self

    # ------------------------------------------------------------------ files

    @classmethod
    @takes()
    def from_toml(cls, path: str | Path) -> Self:
        """Return the arm in a model file.

        Parameters
        ----------
        path : str or Path
            The TOML file, which may name a URDF file, or the URDF file itself.

        Raises
        ------
        InvalidFile
            With the place and value of every problem.
        """
        if Path(path).suffix in (".urdf", ".xacro"):
            return check_table(cls, with_urdf({"urdf": Path(path).name}, Path(path).parent), path, "")
        data, text = read_toml(Path(path), "flexarm-arm/1")
        folder = Path(path).parent
        data = found_from(with_hinges(with_urdf(data, folder)), folder)
        arm = check_table(cls, data, path, text)
        refuse(list(part_problems(arm)), data, path, text)
        return arm

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Return the arm in a model file, as `from_toml`."""
        return cls.from_toml(path)

    @classmethod
    @takes(data=TABLES)
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Return the arm in a dictionary that holds what the TOML file would.

        Raises
        ------
        InvalidParameter
            With the place and value of every problem.
        """
        return check_table(cls, with_hinges(with_urdf(data, Path())))

    def to_dict(self) -> dict[str, Any]:
        """Return the dictionary that `from_dict` reads."""
        return {"format": self.format, "name": self.name, "gravity": list(self.gravity), **self.to_plain()}

    @takes()
    def to_toml(self, path: str | Path) -> None:
        """Write the model file; `from_toml` of it gives an equal arm."""
        write_file(path, self.toml_for(Path(path).parent))

    def toml_for(self, folder: Path, model: Path | None = None) -> str:
        """Return the text of a model file that shall lie in a folder.

        It is that of another model file with other values where its text can hold them.
        """
        found = None if model is None else self._edited(model, folder)
        return toml_text(seen_from(self.to_dict(), folder)) if found is None else found

    def _edited(self, model: Path, folder: Path) -> str | None:
        """Return the text of a model file with the values of this arm; None where it cannot hold them."""
        text = read_text(model)
        with suppress(ValueError):  # of URDF files, too, which are no TOML
            urdf = {key: value for key, value in tomllib.loads(text).items() if key == "urdf"}
            before = {**seen_from(type(self).from_toml(model).to_dict(), model.parent), **urdf}
            after = seen_from({**self.to_dict(), **found_from(urdf, model.parent)}, folder)
            found = edited_toml(text, before, after)
            read = with_urdf(found_from(tomllib.loads(found), place_of(folder)), Path())
            return found if check_table(type(self), read) == self else None
        return None

    @property
    def part_files(self) -> tuple[Path, ...]:
        """The files of its super-elements."""
        return tuple(Path(link.file) for link in self.links if link.type == "superelement")

    # ---------------------------------------------------------------- changes

    @takes(value=NUMBER)
    def with_value(self, key: str, value: float) -> Arm:
        """Return the arm in which one number has another value.

        Parameters
        ----------
        key : str
            As a key of `[uncertainty]` names it: "payloads.load.mass", "points.tip.position.x" or
            "effects.joint_compliance.hinge.stiffness".
        value : float
            The new value [SI].

        Raises
        ------
        InvalidParameter
            If the key means nothing in this arm, or the value is not allowed.
        """
        from flexarm.arm.parameter import with_value

        return with_value(self, key, value)

    def with_effect(self, effect: Effect) -> Self:
        """Return the arm with an effect; one of the same name at the same place is replaced.

        Raises
        ------
        InvalidParameter
            If the effect does not fit the arm, such as a joint that does not exist.
        """
        return self.replace(effects=(*self.effects, effect))

    @takes()
    def without_effect(self, name: str, at: str) -> Self:
        """Return the arm without the effect `name` at `at`.

        Raises
        ------
        InvalidParameter
            If there is none.
        """
        if self.effect(name, at) is None:
            there = [f"{effect.name} at {effect.at}" for effect in self.effects]
            raise InvalidParameter(missing("effect", f"{name} at {at}", there))
        return self.replace(effects=tuple(e for e in self.effects if (e.name, e.at) != (name, at)))

    def effect(self, name: str, at: str) -> Effect | None:
        """Return the effect `name` at `at`, or None."""
        return next((effect for effect in self.effects if (effect.name, effect.at) == (name, at)), None)

    def effects_at(self, at: str) -> tuple[Effect, ...]:
        """Return all effects at a place, in the order in which they were given."""
        return tuple(effect for effect in self.effects if effect.at == at)

    # ------------------------------------------------------------------- parts

    @takes()
    def joint(self, name: str) -> Joint:
        """Return the joint of that name.

        Raises
        ------
        InvalidParameter
            If there is none, listing those that exist.
        """
        return _named("joint", self.joints, name)

    @takes()
    def link(self, name: str) -> Link:
        """Return the link of that name; errors as `joint`."""
        return _named("link", self.links, name)

    @takes()
    def point(self, name: str) -> Point:
        """Return the point of that name; errors as `joint`."""
        return _named("point", self.points, name)

    @takes()
    def payload(self, name: str) -> Payload:
        """Return the payload of that name; errors as `joint`."""
        return _named("payload", self.payloads, name)

    @property
    def moving_joints(self) -> tuple[Joint, ...]:
        """Joints that have a coordinate."""
        return tuple(joint for joint in self.joints if joint.moves)

    @takes()
    def sigma(self, key: str) -> tuple[Any, Any]:
        """Nominal value and 1 sigma, both in SI, of a key of `uncertainty`; see `uncertainty.sigma_of`."""
        try:
            return sigma_of(self, key)
        except ValueError as error:
            raise InvalidParameter(str(error), where="key") from None

    @property
    def warnings(self) -> tuple[Problem, ...]:
        """Implausible values that are allowed, such as a wall that contradicts the area."""
        return tuple(validate(self))

    # ----------------------------------------------------------------- pictures

    @takes()
    def view(self, joints: Mapping[str, float] | None = None, urdf: str | Path | None = None) -> View:
        """Show the undeformed arm in three dimensions, and how each joint moves it.

        Parameters
        ----------
        joints : dict of str to float, optional
            Drive angles, output side [rad, m for a prismatic joint]; default 0.
        urdf : str or Path, optional
            The URDF file whose meshes rigid links are drawn with.

        Returns
        -------
        View
            One page without network: it shows itself in a notebook, `open()` shows it in the browser, and
            `save(path)` writes it.

        Raises
        ------
        InvalidParameter
            If the extra `view` is not installed, once the page is needed.
        """
        return viewed(self, joints=joints, urdf=urdf)

    @takes()
    def plot(self, ax: Axes | None = None, joints: Mapping[str, float] | None = None) -> Axes:
        """Draw the undeformed arm with Matplotlib, in the plane in which it reaches and moves most."""
        return drawn(self, ax=ax, joints=joints)

    # -------------------------------------------------------------------- text

    def __repr__(self) -> str:
        return (
            f"<Arm {self.name!r}: {_count(self.moving_joints, 'moving joint')}, "
            f"{_count(self.links, 'link')}, {_count(self.payloads, 'payload')}, "
            f"{_count(self.effects, 'effect')}>"
        )

    __str__ = __repr__

    def summary(self) -> str:
        """Return a description in a few lines."""
        from flexarm.arm.summary import summary

        return summary(self)


def _count(entries: tuple[Any, ...], word: str) -> str:
    return f"{len(entries)} {word}" + ("" if len(entries) == 1 else "s")


def _named(kind: str, entries: tuple[Entry, ...], name: str) -> Entry:
    for entry in entries:
        if entry.name == name:
            return entry
    raise InvalidParameter(missing(kind, name, [entry.name for entry in entries]))
