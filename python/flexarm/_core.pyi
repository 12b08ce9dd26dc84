"""
C++ core of flexarm (private).
"""

from __future__ import annotations

import collections.abc
import enum
import typing

import numpy
import numpy.typing
import scipy.sparse

__all__: list[str] = [
    "Arm",
    "BeamLink",
    "BeamTheory",
    "BuildInfo",
    "CableTorque",
    "CellBlock",
    "CellType",
    "ChangingTable",
    "CholeskyReport",
    "Closure",
    "ClosureType",
    "DahlFriction",
    "DifferentiatedRun",
    "DifferentiatedSampledRun",
    "Dimension",
    "DriveKind",
    "DriveTrain",
    "EndCushion",
    "Equilibrium",
    "Frame",
    "Gear",
    "HhtStatistics",
    "Hinge",
    "Interface",
    "InterfaceKind",
    "Joint",
    "JointType",
    "Linearisation",
    "Loads",
    "LugreFriction",
    "Material",
    "Modes",
    "Moment",
    "MonotoneCubic",
    "Of",
    "OilColumn",
    "Payload",
    "Pedestal",
    "PiecewisePolynomial",
    "Point",
    "PointLoad",
    "RadialClearance",
    "Readings",
    "ReducedPart",
    "ReducerSpring",
    "ReductionQuality",
    "ReductionStatistics",
    "RigidLink",
    "SampledRun",
    "Section",
    "SectionForces",
    "Snapshots",
    "SolidMaterial",
    "SolidMesh",
    "State",
    "StateDerivative",
    "StateTable",
    "Stepping",
    "SuperElementLink",
    "System",
    "TabulatedFriction",
    "TabulatedTorque",
    "Transient",
    "TransientOptions",
    "Transmission",
    "Varied",
    "ViscousFriction",
    "WoundSpring",
    "assemble_solids",
    "base_wrench",
    "build_info",
    "check_step",
    "closure_force",
    "closure_indeterminacy",
    "cubic_spline",
    "displaced",
    "exp6",
    "frequency_derivatives",
    "in_motion",
    "joint_angles",
    "joint_coordinates",
    "joint_torque",
    "lanes",
    "log6",
    "mass_properties",
    "modes",
    "moment",
    "motor_torques",
    "moved",
    "number_rows",
    "rectangle_section",
    "reduce_part",
    "released",
    "released_derivative",
    "round_section",
    "sample_motion",
    "section_forces",
    "simulate",
    "simulate_differentiated",
    "simulate_side_by_side",
    "smallest_jacobians",
    "snapshots",
    "spline_equations",
    "spline_values",
    "static_derivative",
    "static_equilibrium",
    "stresses",
    "tangents",
    "tube_section",
    "von_mises",
]

class BuildInfo:
    """
    Versions, backends and licence of the core.
    """
    @property
    def blas(self) -> str: ...
    @property
    def build_type(self) -> str: ...
    @property
    def cholmod(self) -> str: ...
    @property
    def compiler(self) -> str: ...
    @property
    def eigen(self) -> str: ...
    @property
    def git(self) -> str:
        """
        Empty where it is unknown.
        """
    @property
    def licence(self) -> str: ...
    @property
    def ordering(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def suitesparse(self) -> str:
        """
        Empty where it is not used.
        """
    @property
    def version(self) -> str: ...

class Frame:
    """
    A rigid placement: rotation matrix R and position x [m].
    """
    def __init__(
        self,
        R: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"] = ...,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
    ) -> None: ...
    def __matmul__(self, other: Frame) -> Frame: ...
    def inverse(self) -> Frame: ...
    @property
    def R(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]: ...
    @R.setter
    def R(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"]) -> None: ...
    @property
    def x(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    @x.setter
    def x(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None: ...

class JointType(enum.Enum):
    fixed = ...
    prismatic = ...
    revolute = ...
    spherical = ...

class ReducerSpring:
    """
    Spring of a reducer: linear, stiffening, with backlash.
    """
    def __init__(
        self,
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        *,
        cubic_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        gap: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        fade_width: typing.SupportsFloat | typing.SupportsIndex = 2e-05,
        loose_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0001,
        loose_damping: typing.SupportsFloat | typing.SupportsIndex = 0.01,
    ) -> None: ...

class CableTorque:
    """
    Cables that bend with the joint.
    """
    def __init__(
        self,
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        rest_angle: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> None: ...

class ViscousFriction:
    """
    Viscous friction.
    """
    def __init__(self, coefficient: typing.SupportsFloat | typing.SupportsIndex) -> None: ...

class DahlFriction:
    """
    Coulomb friction in Dahl's form.
    """
    def __init__(
        self,
        torque: typing.SupportsFloat | typing.SupportsIndex,
        width: typing.SupportsFloat | typing.SupportsIndex = 2e-05,
    ) -> None: ...

class LugreFriction:
    """
    Friction by the LuGre model.
    """
    def __init__(
        self,
        *,
        bristle_stiffness: typing.SupportsFloat | typing.SupportsIndex,
        bristle_damping: typing.SupportsFloat | typing.SupportsIndex,
        viscous: typing.SupportsFloat | typing.SupportsIndex,
        coulomb: typing.SupportsFloat | typing.SupportsIndex,
        breakaway: typing.SupportsFloat | typing.SupportsIndex,
        stribeck_rate: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class Of(enum.Enum):
    across = ...
    angle = ...
    motor_angle = ...
    rate = ...
    torque = ...

class MonotoneCubic:
    """
    Monotone cubic between knots, held beyond them.
    """
    def __call__(self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> typing.Any: ...
    def __init__(
        self,
        x: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
        value: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
    ) -> None: ...
    def slopes(self) -> tuple[float, float]:
        """
        Least and largest slope.
        """

class ChangingTable:
    """
    A table, or two of which one holds from an instant on.
    """
    @typing.overload
    def __init__(self, table: MonotoneCubic) -> None: ...
    @typing.overload
    def __init__(
        self,
        before: MonotoneCubic,
        after: MonotoneCubic,
        instant: typing.SupportsFloat | typing.SupportsIndex,
        duration: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class TabulatedFriction:
    """
    Friction in Dahl's form whose torque a table gives.
    """
    def __init__(self, table: MonotoneCubic, width: typing.SupportsFloat | typing.SupportsIndex) -> None: ...

class TabulatedTorque:
    """
    Torque at the output bearing by a table.
    """
    def __init__(self, of: Of, table: ChangingTable) -> None: ...

class WoundSpring:
    """
    Spring of a reducer that winds up by a table.
    """
    def __init__(self, spring: ReducerSpring, of: Of, windup: ChangingTable) -> None: ...

class OilColumn:
    """
    Oil on both sides of a hydraulic piston.
    """
    def __init__(
        self,
        *,
        bulk_modulus: typing.SupportsFloat | typing.SupportsIndex,
        piston_area: typing.SupportsFloat | typing.SupportsIndex,
        ring_area: typing.SupportsFloat | typing.SupportsIndex,
        dead_volume: typing.SupportsFloat | typing.SupportsIndex,
        retracted: typing.SupportsFloat | typing.SupportsIndex,
        stroke: typing.SupportsFloat | typing.SupportsIndex,
        damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> None: ...

class EndCushion:
    """
    End stops with cushions.
    """
    def __init__(
        self,
        *,
        low: typing.SupportsFloat | typing.SupportsIndex,
        high: typing.SupportsFloat | typing.SupportsIndex,
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        length: typing.SupportsFloat | typing.SupportsIndex,
        damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> None: ...

class RadialClearance:
    """
    Play of a pin: one of its two slides.
    """
    def __init__(self, spring: ReducerSpring, across: typing.SupportsInt | typing.SupportsIndex) -> None: ...

class Transmission:
    """
    psi = phi/scale + amplitude sin(multiple phi + phase) - windup(phi).
    """
    def __init__(
        self,
        *,
        scale: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        amplitude: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        multiple: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        phase: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        windup: MonotoneCubic | None = None,
    ) -> None: ...

class DriveTrain:
    """
    What stands between a motor and its link.
    """
    def __init__(
        self,
        *,
        gear_ratio: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        rotor_inertia: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        transmission: Transmission | None = None,
        stages: collections.abc.Sequence[
            collections.abc.Sequence[
                ReducerSpring
                | CableTorque
                | ViscousFriction
                | DahlFriction
                | LugreFriction
                | TabulatedFriction
                | TabulatedTorque
                | WoundSpring
                | OilColumn
                | EndCushion
                | RadialClearance
            ]
        ] = [],
        motor: collections.abc.Sequence[
            ReducerSpring
            | CableTorque
            | ViscousFriction
            | DahlFriction
            | LugreFriction
            | TabulatedFriction
            | TabulatedTorque
            | WoundSpring
            | OilColumn
            | EndCushion
            | RadialClearance
        ] = [],
        bearing: collections.abc.Sequence[
            ReducerSpring
            | CableTorque
            | ViscousFriction
            | DahlFriction
            | LugreFriction
            | TabulatedFriction
            | TabulatedTorque
            | WoundSpring
            | OilColumn
            | EndCushion
            | RadialClearance
        ] = [],
    ) -> None: ...

class Section:
    """
    Properties of a cross-section, shear factors included in the shear areas.
    """
    def __init__(
        self,
        *,
        area: typing.SupportsFloat | typing.SupportsIndex,
        second_moment_y: typing.SupportsFloat | typing.SupportsIndex,
        second_moment_z: typing.SupportsFloat | typing.SupportsIndex,
        torsion_constant: typing.SupportsFloat | typing.SupportsIndex,
        shear_area_y: typing.SupportsFloat | typing.SupportsIndex = ...,
        shear_area_z: typing.SupportsFloat | typing.SupportsIndex = ...,
    ) -> None: ...
    @property
    def area(self) -> float: ...
    @property
    def second_moment_y(self) -> float: ...
    @property
    def second_moment_z(self) -> float: ...
    @property
    def shear_area_y(self) -> float: ...
    @property
    def shear_area_z(self) -> float: ...
    @property
    def torsion_constant(self) -> float: ...

class Material:
    """
    Isotropic linear elastic material.
    """
    def __init__(
        self,
        *,
        youngs_modulus: typing.SupportsFloat | typing.SupportsIndex,
        shear_modulus: typing.SupportsFloat | typing.SupportsIndex,
        density: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class BeamTheory(enum.Enum):
    euler_bernoulli = ...
    timoshenko = ...

class StateTable:
    """
    What a table of a joint's state gives, in a direction.
    """
    def __init__(
        self,
        *,
        joint: str,
        of: Of,
        table: ChangingTable,
        direction: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
    ) -> None: ...

class BeamLink:
    """
    A straight beam.
    """
    def __init__(
        self,
        *,
        name: str,
        end: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        up: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        section: Section,
        material: Material,
        theory: BeamTheory = ...,
        elements: typing.SupportsInt | typing.SupportsIndex = 4,
        damping_ratio: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        bending_scale: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        mass_scale: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        bow: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        bow_time: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        curvature: StateTable | None = None,
    ) -> None: ...

class RigidLink:
    """
    A rigid body.
    """
    def __init__(
        self,
        *,
        name: str,
        mass: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        com: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        inertia: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"] = ...,
    ) -> None: ...

class SuperElementLink:
    """
    A part reduced to interfaces and internal modes.
    """
    def __init__(
        self,
        *,
        name: str,
        interfaces: collections.abc.Sequence[str],
        frames: collections.abc.Sequence[Frame],
        stiffness: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        mass: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        damping: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"] = ...,
        damping_ratio: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> None: ...

class Payload:
    """
    A concentrated mass.
    """
    def __init__(
        self,
        *,
        name: str,
        link: str,
        position: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        mass: typing.SupportsFloat | typing.SupportsIndex,
        inertia: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"] = ...,
        offset: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        force: StateTable | None = None,
    ) -> None: ...

class Point:
    """
    A place to look at, or to push at.
    """
    def __init__(
        self,
        *,
        name: str,
        link: str,
        position: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        loaded: bool = False,
    ) -> None: ...

class Hinge:
    """
    A hinge on a spring, which nothing drives.
    """
    def __init__(
        self,
        *,
        axis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        type: JointType = JointType.revolute,
        laws: collections.abc.Sequence[
            ReducerSpring
            | CableTorque
            | ViscousFriction
            | DahlFriction
            | LugreFriction
            | TabulatedFriction
            | TabulatedTorque
            | WoundSpring
            | OilColumn
            | EndCushion
            | RadialClearance
        ] = [],
        follows: StateTable | None = None,
    ) -> None: ...

class Joint:
    """
    A joint with its drive train.
    """
    def __init__(
        self,
        *,
        name: str,
        type: JointType,
        parent: str,
        child: str,
        at_end: bool = False,
        origin: Frame,
        axis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        drive_train: DriveTrain,
        mount: collections.abc.Sequence[Hinge] = [],
    ) -> None: ...

class Gear:
    """
    theta of input = ratio times theta of output.
    """
    def __init__(
        self, *, name: str, input: str, output: str, ratio: typing.SupportsFloat | typing.SupportsIndex
    ) -> None: ...

class Pedestal:
    """
    A base that turns on a spring, and may be shaken.
    """
    def __init__(
        self,
        *,
        hinges: collections.abc.Sequence[Hinge],
        axis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        amplitude: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        frequency: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        phase: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> None: ...

class ClosureType(enum.Enum):
    cylindrical = ...
    fixed = ...
    point_on_beam = ...
    point_on_line = ...
    prismatic = ...
    revolute = ...
    spherical = ...
    universal = ...

class Closure:
    """
    Closes a loop of the tree.
    """
    def __init__(
        self,
        *,
        name: str,
        type: ClosureType,
        a: str,
        b: str,
        a_at_end: bool = False,
        b_at_end: bool = False,
        a_origin: Frame,
        b_origin: Frame,
        axis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        second_axis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        mount: collections.abc.Sequence[Hinge] = [],
        bearing: collections.abc.Sequence[
            ReducerSpring
            | CableTorque
            | ViscousFriction
            | DahlFriction
            | LugreFriction
            | TabulatedFriction
            | TabulatedTorque
            | WoundSpring
            | OilColumn
            | EndCushion
            | RadialClearance
        ] = [],
    ) -> None: ...

class Arm:
    """
    An arm as plain data.
    """
    def __init__(
        self,
        *,
        name: str,
        gravity: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        links: collections.abc.Sequence[BeamLink | RigidLink | SuperElementLink],
        joints: collections.abc.Sequence[Joint],
        payloads: collections.abc.Sequence[Payload],
        points: collections.abc.Sequence[Point],
        gears: collections.abc.Sequence[Gear],
        pedestal: Pedestal | None = None,
        closures: collections.abc.Sequence[Closure] = [],
        assembly: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex] = {},
    ) -> None: ...

class DriveKind(enum.Enum):
    free = ...
    link_angle = ...
    locked = ...
    motor_angle = ...
    torque = ...

class PointLoad:
    """
    Force and moment at a point, in base axes, or in the link's if it follows.
    """
    def __init__(
        self,
        *,
        point: typing.SupportsInt | typing.SupportsIndex,
        force: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        moment: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ...,
        follows: bool = False,
    ) -> None: ...

class Loads:
    """
    What acts from outside: gravity and point loads.
    """
    def __init__(
        self,
        *,
        gravity: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        points: collections.abc.Sequence[PointLoad] = [],
    ) -> None: ...
    @property
    def gravity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    @gravity.setter
    def gravity(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None: ...

class State:
    """
    State of an arm at one instant.
    """
    @property
    def frames(self) -> list[Frame]:
        """
        Node frames in the base frame.
        """
    @property
    def multipliers(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def t(self) -> float: ...
    @property
    def v(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...

class System:
    """
    An arm, assembled.
    """
    def __init__(self, arm: Arm, drives: collections.abc.Mapping[str, DriveKind]) -> None: ...
    def count_closures_as(self, nominal: System) -> None:
        """
        Take the conditions of closures that count in a model with nearly the same.
        """
    def in_loop(self, joint: typing.SupportsInt | typing.SupportsIndex) -> bool:
        """
        True for a joint of a loop.
        """
    def joints_to_hold(
        self,
        held: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        candidates: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
    ) -> list[int]:
        """
        Candidates that must be held so that the loops cannot move.
        """
    def part_shape(
        self, state: State, part: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[Frame, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
        """
        Frame of the k-th super-element and its displacements in the freedoms of its matrices.
        """
    def point_frame(self, state: State, point: typing.SupportsInt | typing.SupportsIndex) -> Frame:
        """
        Frame of a point.
        """
    def rigid_state(
        self, joint_values: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]
    ) -> State:
        """
        The undeformed arm.
        """
    @property
    def assembled(self) -> list[float]:
        """
        Joint values at which loops were closed first; empty without closures.
        """
    @property
    def mass(self) -> float:
        """
        Mass of everything [kg].
        """
    @property
    def n_nodes(self) -> int: ...
    @property
    def n_unknowns(self) -> int: ...
    @property
    def redundant(self) -> int:
        """
        Conditions of closures that others repeat.
        """

class PiecewisePolynomial:
    """
    Piecewise polynomial as scipy.interpolate.PPoly.
    """
    @staticmethod
    def constant(value: typing.SupportsFloat | typing.SupportsIndex) -> PiecewisePolynomial: ...
    def __call__(
        self, t: typing.SupportsFloat | typing.SupportsIndex
    ) -> typing.Annotated[list[float], "FixedSize(3)"]:
        """
        Value and two derivatives.
        """
    def __init__(
        self,
        breaks: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ) -> None: ...

class Equilibrium:
    """
    An equilibrium at rest.
    """
    @property
    def iterations(self) -> int: ...
    @property
    def load_steps(self) -> int: ...
    @property
    def residual(self) -> float:
        """
        Largest unbalanced force [N].
        """
    @property
    def state(self) -> State: ...

class Modes:
    """
    Modes about an equilibrium.
    """
    @property
    def damped_frequency_hz(self) -> list[float]: ...
    @property
    def damping_ratio(self) -> list[float]: ...
    @property
    def frequency_hz(self) -> list[float]: ...
    @property
    def iterations(self) -> int: ...
    @property
    def shapes(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...

class SectionForces:
    """
    Section forces at both ends of a beam.
    """
    @property
    def end(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]: ...
    @property
    def start(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]: ...

class HhtStatistics:
    """
    Counts of a run.
    """
    @property
    def factorisations(self) -> int: ...
    @property
    def halvings(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def steps(self) -> int: ...

class Dimension(enum.Enum):
    automatic = ...
    plane = ...
    space = ...

class TransientOptions:
    """
    Options of a run.
    """

    consistent_forces: bool
    dimension: Dimension
    record_energies: bool
    record_forces: bool
    record_joints: bool
    record_points: bool
    record_rotations: bool
    def __init__(self) -> None: ...
    @property
    def alpha(self) -> float: ...
    @alpha.setter
    def alpha(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def end(self) -> float: ...
    @end.setter
    def end(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def start(self) -> float: ...
    @start.setter
    def start(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def step(self) -> float: ...
    @step.setter
    def step(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def tolerance(self) -> float: ...
    @tolerance.setter
    def tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None: ...

class Transient:
    """
    A run: one column an instant.
    """
    @property
    def angular_rate(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def base_wrench(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def cancelled(self) -> bool: ...
    @property
    def damped(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def dimension(self) -> int:
        """
        2 if the run was computed in a plane, else 3.
        """
    @property
    def drive_angle(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def drive_rate(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def elastic(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def final_state(self) -> State: ...
    @property
    def gravity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def joint_angle(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def joint_rate(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def joint_torque(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def kinetic(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def motor_torque(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def orientation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def position(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def seconds(self) -> float: ...
    @property
    def section_forces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def statistics(self) -> HhtStatistics: ...
    @property
    def time(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def work(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...

class StateDerivative:
    """
    Derivative of a state, one column a parameter.
    """
    @property
    def position(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @velocity.setter
    def velocity(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None: ...

class Varied:
    """
    Models with a parameter a little up and a little down.
    """
    def __init__(
        self,
        plus: System,
        minus: System,
        up: typing.SupportsFloat | typing.SupportsIndex,
        down: typing.SupportsFloat | typing.SupportsIndex,
        drives_plus: collections.abc.Sequence[PiecewisePolynomial] = [],
        drives_minus: collections.abc.Sequence[PiecewisePolynomial] = [],
    ) -> None: ...
    @property
    def down(self) -> float: ...
    @property
    def minus(self) -> System: ...
    @property
    def plus(self) -> System: ...
    @property
    def up(self) -> float: ...

class DifferentiatedRun:
    """
    A run and the derivatives of its columns.
    """
    @property
    def derivatives(self) -> Transient:
        """
        As the run's columns, but one row for each row and parameter.
        """
    @property
    def run(self) -> Transient: ...

class SampledRun:
    """
    A run under a sampled controller.
    """
    def __init__(
        self,
        system: System,
        equilibrium: Equilibrium,
        drives: collections.abc.Sequence[PiecewisePolynomial],
        options: TransientOptions,
    ) -> None: ...
    def advance(
        self,
        motor_torque: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        n_steps: typing.SupportsInt | typing.SupportsIndex,
    ) -> None:
        """
        Steps with motor torques held.
        """
    def point_position(
        self, point: typing.SupportsInt | typing.SupportsIndex
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    def point_velocity(
        self, point: typing.SupportsInt | typing.SupportsIndex
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    def result(self) -> Transient:
        """
        What was recorded so far.
        """
    @property
    def done(self) -> bool: ...
    @property
    def drive_angles(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def drive_rates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def joint_angles(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def joint_rates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def state(self) -> State: ...
    @property
    def statistics(self) -> HhtStatistics: ...
    @property
    def time(self) -> float: ...

class DifferentiatedSampledRun:
    """
    A run under a sampled controller, with derivatives.
    """
    def __init__(
        self,
        system: System,
        equilibrium: Equilibrium,
        drives: collections.abc.Sequence[PiecewisePolynomial],
        options: TransientOptions,
        varied: collections.abc.Sequence[Varied],
        initial: StateDerivative,
    ) -> None: ...
    def advance(
        self,
        motor_torque: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        torque_slopes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        n_steps: typing.SupportsInt | typing.SupportsIndex,
    ) -> None:
        """
        Steps with motor torques and their derivatives held.
        """
    def point_position_slopes(
        self, point: typing.SupportsInt | typing.SupportsIndex
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def result(self) -> DifferentiatedRun:
        """
        What was recorded so far.
        """
    @property
    def drive_angle_slopes(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def drive_rate_slopes(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def joint_angle_slopes(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def joint_rate_slopes(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def run(self) -> SampledRun:
        """
        The run itself, to look at.
        """

class Linearisation:
    """
    Where factors were made.
    """

class Moment:
    """
    An instant to go on from.
    """
    def arrays(self) -> dict[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]:
        """
        The state as named arrays.
        """
    def counts(self) -> tuple[int, int, float, float]:
        """
        Steps, accepted steps, contraction, step of the kept matrix.
        """
    def factored_arrays(self) -> dict[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]:
        """
        The state at which the kept matrix was factored; empty without.
        """
    def factored_forces(self) -> dict[int, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]]:
        """
        Forces at points that were part of that matrix.
        """
    @property
    def state(self) -> State: ...
    @property
    def steps(self) -> int: ...
    @property
    def time(self) -> float: ...

class Stepping:
    """
    One step at a time.
    """
    def __init__(
        self,
        system: System,
        step: typing.SupportsFloat | typing.SupportsIndex,
        alpha: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def advance(
        self,
        moment: Moment,
        inputs: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]", "flags.c_contiguous"],
        points: collections.abc.Sequence[PointLoad] = [],
    ) -> Moment:
        """
        The next moment; rows of inputs: value, rate, acceleration.
        """
    def start(self, equilibrium: Equilibrium) -> Moment:
        """
        The moment of an equilibrium, at t = 0.
        """
    @property
    def statistics(self) -> HhtStatistics: ...

class Snapshots:
    """
    States looked at one by one.
    """
    @property
    def acceleration(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def run(self) -> Transient: ...

class Readings:
    """
    Joints and points of one state after another.
    """
    def __init__(self, system: System) -> None: ...
    def joint(
        self, state: typing.Any, joint: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[float, float, float, float, float, float]:
        """
        Angle and rate of link and drive, torque on the child and of the motor.
        """
    def point(
        self, state: typing.Any, point: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"],
    ]:
        """
        Position, velocity, rotation, angular rate (own axes) and acceleration of a point.
        """

class CellType(enum.Enum):
    hex20 = ...
    hex8 = ...
    tet10 = ...
    tet4 = ...

class SolidMaterial:
    """
    Isotropic linear elastic material of a solid.
    """
    def __init__(
        self,
        youngs_modulus: typing.SupportsFloat | typing.SupportsIndex,
        poisson_ratio: typing.SupportsFloat | typing.SupportsIndex,
        density: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class CellBlock:
    """
    Cells of one type, nodes in the order of VTK.
    """
    def __init__(
        self,
        type: CellType,
        nodes: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, n]"],
        material: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"],
    ) -> None: ...

class SolidMesh:
    """
    A solid part: points, cells, materials.
    """
    def __init__(
        self,
        points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"],
        blocks: collections.abc.Sequence[CellBlock],
        materials: collections.abc.Sequence[SolidMaterial],
    ) -> None: ...
    @property
    def n_dof(self) -> int: ...
    @property
    def n_points(self) -> int: ...

class InterfaceKind(enum.Enum):
    average = ...
    rigid = ...

class Interface:
    """
    Points of a part tied to a frame of six freedoms.
    """
    def __init__(
        self,
        name: str,
        position: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
        rotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"],
        points: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        kind: InterfaceKind,
        weights: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"] = ...,
    ) -> None: ...
    @property
    def kind(self) -> InterfaceKind: ...
    @property
    def name(self) -> str: ...
    @property
    def points(self) -> list[int]: ...
    @property
    def position(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    @property
    def rotation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]: ...
    @property
    def weights(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Empty: equal.
        """

class CholeskyReport:
    """
    How the factor of a part came about.
    """
    @property
    def backend(self) -> str: ...
    @property
    def blas(self) -> str: ...
    @property
    def entries(self) -> float: ...
    @property
    def entries_amd(self) -> float: ...
    @property
    def entries_metis(self) -> float:
        """
        0 where there is no METIS.
        """
    @property
    def operations(self) -> float: ...
    @property
    def ordering(self) -> str: ...
    @property
    def seconds_factor(self) -> float: ...
    @property
    def seconds_ordering(self) -> float: ...

class ReductionStatistics:
    """
    Sizes, backends and seconds of a reduction.
    """
    @property
    def factor(self) -> CholeskyReport: ...
    @property
    def lanczos_block(self) -> int: ...
    @property
    def lanczos_steps(self) -> int: ...
    @property
    def n_freedoms(self) -> int: ...
    @property
    def n_inner(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def seconds_check(self) -> float: ...
    @property
    def seconds_factor(self) -> float: ...
    @property
    def seconds_interfaces(self) -> float: ...
    @property
    def seconds_matrices(self) -> float: ...
    @property
    def seconds_modes(self) -> float: ...
    @property
    def seconds_quality(self) -> float: ...
    @property
    def unused_points(self) -> int: ...

class ReductionQuality:
    """
    What a reduction is good for.
    """
    @property
    def centre(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]: ...
    @property
    def effective_mass(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (mode, 6) [kg, kg m2]
        """
    @property
    def free_frequency_error(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def free_frequency_hz(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def inertia(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]:
        """
        About the centre of mass.
        """
    @property
    def left_out_frequency_hz(self) -> float: ...
    @property
    def mass(self) -> float: ...
    @property
    def mode_residual(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def movable_mass(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (6) of all modes together.
        """
    @property
    def rigid_body_correction(self) -> float: ...
    @property
    def trusted_frequency_hz(self) -> float: ...

class ReducedPart:
    """
    A part reduced to interfaces and inner modes.
    """
    @property
    def frequency_hz(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def inertia_load(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (dof, 3)
        """
    @property
    def mass(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def quality(self) -> ReductionQuality: ...
    @property
    def recovery(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (3 n_points, dof)
        """
    @property
    def statistics(self) -> ReductionStatistics: ...
    @property
    def stiffness(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...

def assemble_solids(
    mesh: SolidMesh, lumped: bool = False, threads: typing.SupportsInt | typing.SupportsIndex = 0
) -> tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
    """
    Stiffness and mass, lower triangles; freedom 3 point + axis.
    """

def base_wrench(
    system: System, state: State
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]:
    """
    What the arm puts on the base.
    """

def build_info() -> BuildInfo:
    """
    What this build of the core is made of.
    """

def check_step(step: typing.SupportsFloat | typing.SupportsIndex) -> None:
    """
    Refuses a time step that is too short or not finite.
    """

def closure_force(
    system: System, state: State, closure: typing.SupportsInt | typing.SupportsIndex
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]:
    """
    Force and moment that a closure puts on its link b at its place there, base axes.
    """

def closure_indeterminacy(
    system: System, state: State, closure: typing.SupportsInt | typing.SupportsIndex
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]:
    """
    Largest change of each entry of closure_force by unit forces that the loops do not tell.
    """

def cubic_spline(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    y: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
    """
    Coefficients of the not-a-knot spline through samples.
    """

def displaced(
    system: System,
    state: State,
    increment: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    v: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    v_dot: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
) -> State:
    """
    A state moved, with velocities and accelerations.
    """

def exp6(h: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[6, 1]"]) -> Frame:
    """
    Exponential of SE(3).
    """

def frequency_derivatives(
    system: System,
    equilibrium: Equilibrium,
    count: typing.SupportsInt | typing.SupportsIndex,
    varied: collections.abc.Sequence[Varied],
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
    """
    df/dp of the lowest modes, (mode, parameter) [Hz per unit].
    """

def in_motion(equilibrium: Equilibrium, along: StateDerivative) -> Equilibrium:
    """
    The equilibrium, passed with the velocities of its derivative by the first parameter.
    """

def joint_angles(
    system: System, state: State
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    Angle of every link about its joint.
    """

def joint_coordinates(system: System) -> list[tuple[int, int]]:
    """
    Row of theta and phi of each joint among the velocities, -1 without.
    """

def joint_torque(system: System, state: State, joint: typing.SupportsInt | typing.SupportsIndex) -> float:
    """
    Torque on the child about the axis.
    """

def lanes() -> int:
    """
    Arms that this processor computes side by side; 0: none.
    """

def log6(H: Frame) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, 1]"]:
    """
    Logarithm of SE(3).
    """

def mass_properties(
    mesh: SolidMesh,
) -> tuple[
    float,
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"],
]:
    """
    Mass, first moment and inertia about the origin.
    """

def modes(
    system: System, equilibrium: Equilibrium, count: typing.SupportsInt | typing.SupportsIndex
) -> Modes:
    """
    Lowest modes about an equilibrium.
    """

def moment(
    system: System,
    state: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]],
    factored: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]],
    forces: collections.abc.Mapping[
        typing.SupportsInt | typing.SupportsIndex,
        typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"],
    ],
    counts: tuple[
        typing.SupportsInt | typing.SupportsIndex,
        typing.SupportsInt | typing.SupportsIndex,
        typing.SupportsFloat | typing.SupportsIndex,
        typing.SupportsFloat | typing.SupportsIndex,
    ],
) -> Moment:
    """
    The moment of stored arrays.
    """

def motor_torques(
    system: System, state: State, friction: bool
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    Motor torques, output-referred.
    """

def moved(
    system: System,
    state: State,
    derivative: StateDerivative,
    k: typing.SupportsInt | typing.SupportsIndex,
    amount: typing.SupportsFloat | typing.SupportsIndex,
) -> State:
    """
    The state moved along its derivative by an amount of the k-th parameter.
    """

def number_rows(
    text: str,
    cells: typing.SupportsInt | typing.SupportsIndex,
    columns: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"] | None:
    """
    Numbers of some columns of rows of text; None if one is no number.
    """

def rectangle_section(
    width: typing.SupportsFloat | typing.SupportsIndex, height: typing.SupportsFloat | typing.SupportsIndex
) -> Section:
    """
    Rectangular section.
    """

def reduce_part(
    stiffness: typing.Any,
    mass: typing.Any,
    coordinates: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"],
    interfaces: collections.abc.Sequence[Interface],
    modes: typing.SupportsInt | typing.SupportsIndex = 0,
    max_frequency: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    progress: typing.Any = None,
) -> ReducedPart:
    """
    Craig-Bampton (modes) or Guyan (none) reduction of a free part.
    """

def released(held: System, equilibrium: Equilibrium, system: System) -> Equilibrium:
    """
    The equilibrium with motors let go.
    """

def released_derivative(held: System, derivative: StateDerivative, system: System) -> StateDerivative:
    """
    The derivative with motors let go.
    """

def round_section(diameter: typing.SupportsFloat | typing.SupportsIndex) -> Section:
    """
    Section of a solid rod.
    """

def sample_motion(
    time: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    values: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"],
    rates: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"],
    instants: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    early: typing.SupportsFloat | typing.SupportsIndex,
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
    """
    Values of a motion at any instants, by cubics between its steps.
    """

def section_forces(
    system: System, state: State, loads: Loads, link: typing.SupportsInt | typing.SupportsIndex
) -> SectionForces:
    """
    Section forces of a link.
    """

def simulate(
    system: System,
    equilibrium: Equilibrium,
    drives: collections.abc.Sequence[PiecewisePolynomial],
    options: TransientOptions,
    progress: typing.Any = None,
) -> Transient:
    """
    A run from equilibrium along drives.
    """

def simulate_differentiated(
    system: System,
    equilibrium: Equilibrium,
    drives: collections.abc.Sequence[PiecewisePolynomial],
    options: TransientOptions,
    varied: collections.abc.Sequence[Varied],
    initial: StateDerivative,
    progress: typing.Any = None,
) -> DifferentiatedRun:
    """
    A run with derivatives.
    """

def simulate_side_by_side(
    arms: collections.abc.Sequence[tuple[System, Equilibrium]],
    drives: collections.abc.Sequence[PiecewisePolynomial],
    options: TransientOptions,
    progress: typing.Any = None,
) -> list[Transient | None]:
    """
    Runs of (system, equilibrium) along the same drives; None for each that is to run alone.
    """

def smallest_jacobians(
    mesh: SolidMesh,
) -> list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
    """
    Smallest scaled Jacobian of each cell, one array a block; 1 is ideal, 0 flat, below inverted.
    """

def snapshots(system: System, states: collections.abc.Sequence[State], loads: Loads) -> Snapshots:
    """
    What a run would have recorded in these states.
    """

def spline_equations(
    time: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    values: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    breaks: typing.Annotated[numpy.typing.NDArray[numpy.int64], "[m, 1]"],
) -> tuple[
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
]:
    """
    Normal equations of a cubic least-squares spline: lower band and right side.
    """

def spline_values(
    time: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    breaks: typing.Annotated[numpy.typing.NDArray[numpy.int64], "[m, 1]"],
    coefficients: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    Values of a cubic spline at its samples.
    """

def static_derivative(
    system: System,
    equilibrium: Equilibrium,
    varied: collections.abc.Sequence[Varied],
    t: typing.SupportsFloat | typing.SupportsIndex = 0.0,
) -> StateDerivative:
    """
    Derivative of an equilibrium with drives as they are at time t.
    """

def static_equilibrium(
    system: System,
    joint_values: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
    loads: Loads,
    time: typing.SupportsFloat | typing.SupportsIndex = 0.0,
) -> Equilibrium:
    """
    Equilibrium of the loaded arm, drives held, at a time.
    """

def stresses(
    mesh: SolidMesh, displacements: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 6]"]:
    """
    Stresses of the points: xx, yy, zz, xy, yz, zx.
    """

def tangents(
    system: System, equilibrium: Equilibrium
) -> tuple[
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
]:
    """
    M, C, K of the free coordinates and the constraint Jacobian, dense.
    """

def tube_section(
    outer_diameter: typing.SupportsFloat | typing.SupportsIndex,
    thickness: typing.SupportsFloat | typing.SupportsIndex,
) -> Section:
    """
    Section of a tube.
    """

def von_mises(
    mesh: SolidMesh, displacements: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    Von Mises stress of the points.
    """
