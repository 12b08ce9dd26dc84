"""The hinge's dimensions, from `hinge.toml` or a file of the user's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexarm.material import Material
from flexarm.tables import Inconsistent, Name, Number, Table, check_table, read_toml, value_in
from flexarm.tables.table import Whole

FORMAT = "flexarm-hinge/1"
PARTS = ("housing", "reducer", "hub")
"""The three groups of the paper's Fig. 2, from the base outwards."""
TUBE_RADIUS = 0.03012
"""Of the tube that is welded to the hub, outside [m]."""

Length = Annotated[Number, value_in("m", "length", gt=0)]
Mass = Annotated[Number, value_in("kg", "mass", ge=0)]
Count = Annotated[Whole, Field(ge=0, le=500)]
Time = Annotated[Number, value_in("s", "damping over stiffness", ge=0)]


class HousingSize(Table):
    """Base flange, shell, web with the motor shaft's bearing, ring that holds the reducer [m]."""

    flange_radius: Length
    flange_thickness: Length
    radius: Length
    wall: Length
    length: Length
    web_offset: Length
    web_thickness: Length
    bearing_radius: Length
    seat_width: Length


class ReducerSize(Table):
    """Body, output shaft, output flange [m]."""

    body_radius: Length
    body_thickness: Length
    shaft_diameter: Length
    shaft_length: Length
    flange_radius: Length
    flange_thickness: Length


class HubSize(Table):
    """Disc, bell, arm flange [m]."""

    radius: Length
    wall: Length
    disc_thickness: Length
    bore: Length
    length: Length
    flange_radius: Length
    flange_width: Length


class MeshSize(Table):
    """Largest edge of a cell [m], and cells around the axis."""

    size: Length
    around: Whole = Field(ge=16, le=400, multiple_of=16)


class ModeCounts(Table):
    """Internal modes kept of each part."""

    housing: Count
    reducer: Count
    hub: Count


class DampingTimes(Table):
    """C = time x K for each part [s]."""

    housing: Time
    reducer: Time
    hub: Time


class RigidBodies(Table):
    """The bodies that are not elastic: motor, its rotor, the two halves of the cross-roller ring."""

    motor_mass: Mass
    rotor_mass: Mass
    rotor_inertia: Number = value_in("kg m2", "inertia of the rotor about its axis", ge=0)
    ring_mass: Mass
    ring_radius: Length


class HingeDesign(Table):
    """Dimensions, mesh and reduction of the solid hinge.

    Examples
    --------
    >>> from flexarm.mockup import HingeDesign
    >>> HingeDesign.from_toml().reducer.shaft_diameter
    0.04
    """

    format: Literal["flexarm-hinge/1"] = "flexarm-hinge/1"
    name: Name = "hinge"
    steel: Material
    """Of all solid parts."""
    housing: HousingSize
    reducer: ReducerSize
    hub: HubSize
    """Their dimensions [m]."""
    mesh: MeshSize
    modes: ModeCounts
    damping_time: DampingTimes
    rigid: RigidBodies
    """How fine, how many internal modes, how damped; and the lumped bodies."""

    @classmethod
    def from_toml(cls, path: str | Path | None = None) -> Self:
        """Read the design from a file; without one, the hinge that ships with flexarm.

        Raise InvalidFile with the place and value of every problem.
        """
        file = Path(__file__).with_name("hinge.toml") if path is None else Path(path)
        data, text = read_toml(file, FORMAT)
        return check_table(cls, data, file, text)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        housing, reducer, hub = self.housing, self.reducer, self.hub
        room = housing.length - housing.seat_width - housing.flange_thickness
        below = housing.web_offset - housing.flange_thickness - housing.web_thickness / 2
        above = housing.length - housing.seat_width - housing.web_offset - housing.web_thickness / 2
        back = self.output_place - hub.length
        limits = [
            ("housing", "radius", housing.radius, housing.flange_radius, "flange_radius"),
            ("reducer", "body_radius", reducer.body_radius, housing.radius, "housing.radius"),
            ("housing", "seat_width", 0.0, room, "what length and flange_thickness leave"),
            ("housing", "bearing_radius", housing.bearing_radius, self.inner_radius, "radius - wall"),
            ("reducer", "shaft_diameter", reducer.shaft_diameter / 2, reducer.flange_radius, "flange_radius"),
            ("reducer", "body_radius", reducer.shaft_diameter / 2, reducer.body_radius, "body_radius"),
            ("reducer", "flange_radius", reducer.flange_radius, self.bell_radius, "hub.radius - hub.wall"),
            ("hub", "bore", hub.bore, reducer.flange_radius, "reducer.flange_radius"),
            ("hub", "radius", hub.radius, hub.flange_radius, "flange_radius"),
            ("hub", "flange_width", TUBE_RADIUS, hub.flange_width / 2, "half of it; the tube is welded on"),
            ("hub", "flange_width", hub.flange_width / 2, min(self.output_place, -back), "the bell's length"),
            ("hub", "length", self.seat_place, back, "a clearance to the reducer's body"),
            (
                "reducer",
                "body_thickness",
                reducer.body_thickness,
                housing.seat_width + 1e-9,
                "housing.seat_width",
            ),
        ]
        wrong = [
            ((table, key), f"does not fit: {value:g} m must be below {most:g} m ({by})")
            for table, key, value, most, by in limits
            if not value < most
        ]
        if min(below, above) <= 0:
            wrong.append((("housing", "web_offset"), "puts the web into the flange or the reducer's ring"))
        if wrong:
            raise Inconsistent(*wrong)
        return self

    @property
    def inner_radius(self) -> float:
        """Radius of the housing's shell [m]."""
        return self.housing.radius - self.housing.wall

    @property
    def bell_radius(self) -> float:
        """Inner radius of the hub's bell [m]."""
        return self.hub.radius - self.hub.wall

    @property
    def seat_place(self) -> float:
        """Place where the output shaft leaves the reducer's body, along the axis from the arm's plane [m].

        The arm's plane is in the middle of the shaft: the end of a cantilever that is loaded there sinks
        without tilting, F l²/(2 E I) - (F l/2) l/(E I) = 0.
        """
        return -self.reducer.shaft_length / 2

    @property
    def base_place(self) -> float:
        """Place where the housing stands on the base, along the axis [m]."""
        return self.seat_place - self.housing.length

    @property
    def output_place(self) -> float:
        """Place where the hub is bolted to the reducer's output flange, along the axis [m]."""
        return self.reducer.shaft_length / 2 + self.reducer.flange_thickness


def bench_design() -> HingeDesign:
    """Return the hinge of the virtual mock-up, which differs from its drawing within tolerances.

    The shipped design on a finer mesh and with more modes, its shaft and its bell as thick as usual
    tolerances let them be (50 um of 40 mm, 0.1 mm of 12 mm).
    """
    drawn = HingeDesign.from_toml()
    return drawn.replace(
        name="bench",
        reducer=drawn.reducer.replace(shaft_diameter=drawn.reducer.shaft_diameter - 5e-5),
        hub=drawn.hub.replace(wall=drawn.hub.wall - 1e-4),
        mesh=drawn.mesh.replace(size=0.7 * drawn.mesh.size),
        modes=ModeCounts(housing=12, reducer=0, hub=12),
    )
