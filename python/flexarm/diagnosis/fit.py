r"""Effects fitted through the full simulation, with everything uncertain eliminated along.

    min over u of  C(r(u)) + sum_i ln(1 + (z_i/3)^2),    z_i = (u_i - m_i)/s_i                         (1)

u are the effects' parameters, logarithms where their priors are logarithmic, C the residual that clocks,
frames and nominal values cannot explain (`flexarm.diagnosis.projection`), m and s mode and sigma of a prior.
The prior is widened to a third of its weight and has Student's wide tails, since it need not know this
machine: it keeps what the data do not determine, such as a damping, at plausible values, and hardly moves
what they do. SciPy's least_squares solves (1) within bounds. Its derivatives come from finite steps, as laws
that are not smooth need them, and from there on from Broyden's update [Broyden1965] while that foretells what
a step does,

    J' = J + (r(z') - r(z) - J dz) dz^T/|dz|^2,   dz = z' - z                                         (2)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log, log1p

import numpy as np
from numpy.typing import NDArray

from flexarm.arm import Arm
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.diagnosis.candidates import Candidate, value_of
from flexarm.diagnosis.observed import Observed
from flexarm.diagnosis.projection import Projection
from flexarm.diagnosis.unknowns import Unknowns
from flexarm.errors import InvalidParameter, NotConverged

Floats = NDArray[np.float64]

STEP = 1e-2
"""Of the differences, in sigmas of a prior: laws with corners need steps that reach beyond them."""
FORETOLD = 0.25
"""Part of a step's effect that (2) may have missed before differences are taken anew."""
LIKELY = 2.0
"""Sigmas within which nominal values are centred."""
CENTRED, LESS = 3, 0.98
"""Rounds in which nominal values are centred, and the part of the gap below which one was worth while."""
CORNERS = ("backlash", "coulomb_friction", "joint_hysteresis", "motor_friction")
"""Laws with corners."""
REACH = {"log": 8.0, "linear": 400.0, "uniform": 40.0}
"""Bounds of a parameter in sigmas of its prior, by the prior's scale: factors of thousands, or turns."""


@dataclass(frozen=True)
class Coordinate:
    """A free parameter on the scale of its prior.

    Attributes
    ----------
    candidate : int
        Which effect of the set.
    name : str
        Of the parameter.
    prior : Prior
        At the start of the fit.
    """

    candidate: int
    name: str
    prior: Prior

    def z(self, value: float) -> float:
        """Sigmas from the mode."""
        mode, below, above = self._pieces()
        u = log(value) if self.prior.scale == "log" else value
        return (u - mode) / (below if u < mode else above)

    def value(self, z: float) -> float:
        """The parameter."""
        mode, below, above = self._pieces()
        u = mode + z * (below if z < 0 else above)
        return exp(u) if self.prior.scale == "log" else u

    def slope(self, z: float) -> float:
        """d(value)/dz."""
        _, below, above = self._pieces()
        size = below if z < 0 else above
        return size * self.value(z) if self.prior.scale == "log" else size

    def log_density(self, z: float) -> float:
        """ln p(z): Student's t with three degrees of freedom, as some machines are unlike all others."""
        if self.prior.scale == "uniform":
            return -log(8.0)
        return -2.0 * log1p(z * z / 3.0) - 1.0008889  # ln of 2/(pi sqrt 3)

    def _pieces(self) -> tuple[float, float, float]:
        low, mode, high = self.prior.low, self.prior.typical, self.prior.high
        if self.prior.scale == "uniform":
            return mode, (high - low) / 8, (high - low) / 8
        if self.prior.scale == "log":
            low, mode, high = log(low), log(mode), log(high)
        return mode, (mode - low) / QUANTILE, (high - mode) / QUANTILE


@dataclass(frozen=True, eq=False)
class Fit:
    """A model with a set of effects, fitted.

    Attributes
    ----------
    members : tuple of Candidate
        The effects, each at its optimum.
    coordinates, z : tuple of Coordinate and ndarray, shape (k,)
        What was fitted, in sigmas of the priors.
    arm : Arm
        With the effects, unknowns at their centres.
    residual : ndarray, shape (n,)
        Of that model, eq. (1) of `observed`.
    rest : ndarray, shape (n + m,)
        Of which clocks, frames and nominal values explain nothing more.
    slopes : ndarray, shape (n, k)
        Derivatives of `residual` by z.
    unknowns, projection
        What was eliminated.
    converged : bool
        Whether the fit came to rest.
    """

    members: tuple[Candidate, ...]
    coordinates: tuple[Coordinate, ...]
    z: Floats
    arm: Arm
    residual: Floats
    rest: Floats
    slopes: Floats
    unknowns: Unknowns
    projection: Projection
    converged: bool = True

    @property
    def cost(self) -> float:
        """C of (1)."""
        return float(self.rest @ self.rest)

    @property
    def places(self) -> tuple[tuple[str, str], ...]:
        """Name and place of each effect."""
        return tuple(member.place for member in self.members)


@dataclass(eq=False)
class Fitter:
    """What all fits share: records, unknowns, and derivatives by these at the nominal model.

    Attributes
    ----------
    observed : Observed
        The records.
    unknowns : Unknowns
        Clocks, frames, nominal values; its `arm` is the nominal model.
    slopes : ndarray
        Derivatives of the residual by them, at `at`.
    at : ndarray
        Where the unknowns are, from the centres of their priors.
    correction : ndarray
        Added to residuals: what simulations miss for their time steps, at `at`.
    """

    observed: Observed
    unknowns: Unknowns
    slopes: Floats
    at: Floats
    correction: Floats

    def __post_init__(self) -> None:
        self._projections: dict[frozenset[str], tuple[Unknowns, Projection]] = {}
        centres = np.array([u.centre for u in self.unknowns.each])
        self.start = self.unknowns.put(self.unknowns.arm, centres + self.at)

    @classmethod
    def nominal(cls, observed: Observed, unknowns: Unknowns) -> Fitter:
        """About the nominal model."""
        arm = unknowns.arm
        slopes = observed.slopes(arm, unknowns.keys)
        return cls(observed, unknowns, slopes, np.zeros(len(unknowns.each)), observed.correction(arm))

    def about(self, fit: Fit) -> Fitter:
        """The same about a fitted model, where derivatives are those of the model with its effects."""
        at = self.at.copy()
        best = dict(zip(fit.unknowns.keys, fit.projection.best(fit.residual), strict=True))
        for k, unknown in enumerate(self.unknowns.each):
            at[k] = unknown.kept(best.get(unknown.key, 0.0))
        return self._moved(at, fit)

    def _moved(self, at: Floats, fit: Fit) -> Fitter:
        """The same with unknowns elsewhere."""
        there = replace(self, at=at)
        arm = there.with_effects(fit.members)
        keys = fit.unknowns.keys
        slopes = self.slopes.copy()
        slopes[:, [self.unknowns.keys.index(key) for key in keys]] = self.observed.slopes(arm, keys)
        return replace(there, slopes=slopes, correction=self.observed.correction(arm))

    def centred(self) -> Fitter:
        """The same about nominal values that fit better, for those that act otherwise than in proportion.

        Clocks and frames stay: effects may take their places. So do values where they are hardly likely.
        """
        there, fit = self, self.fit(())
        nominal = np.array([unknown.kind == "nominal" for unknown in self.unknowns.each])
        reach = LIKELY * self.unknowns.sigma
        for _ in range(CENTRED):
            best = np.clip(fit.projection.best(fit.residual), -reach, reach)
            kept = [u.kept(float(x)) for u, x in zip(self.unknowns.each, best, strict=True)]
            about = there._moved(np.where(nominal, kept, 0.0), fit)
            better = about.fit(())
            if better.cost > LESS * fit.cost:
                break
            there, fit = about, better
        return there

    def residual(self, members: Sequence[Candidate]) -> Floats:
        """Of the model with effects, to first order at the centres of the unknowns' priors."""
        raw = self.observed.residual(self.with_effects(members)) + self.correction
        taken = self.taken(members)
        at = np.array(
            [0.0 if u.key in taken else x for u, x in zip(self.unknowns.each, self.at, strict=True)]
        )
        return raw - self.slopes @ at if at.any() else raw

    def taken(self, members: Sequence[Candidate]) -> frozenset[str]:
        """Unknowns that are effects of a set."""
        fitted = {(member.name, member.at) for member in members}
        return frozenset(
            u.key for u in self.unknowns.each if u.key.startswith("effects.") and u.place in fitted
        )

    def eliminated(self, members: Sequence[Candidate]) -> tuple[Unknowns, Projection]:
        """Unknowns that a set of effects leaves: a clock or a zero that is an effect is none of them."""
        return self.without(self.taken(members))

    def without(self, taken: frozenset[str]) -> tuple[Unknowns, Projection]:
        """All unknowns but some, and what eliminates them."""
        if taken not in self._projections:
            left = self.unknowns.without(set(taken))
            keep = [k for k, u in enumerate(self.unknowns.each) if u.key not in taken]
            self._projections[taken] = (left, Projection(self.slopes[:, keep], left.sigma))
        return self._projections[taken]

    def fit(self, members: Sequence[Candidate], evaluations: int = 8, tolerance: float = 2e-3) -> Fit:
        """Eq. (1) for a set of effects that start at their own values.

        Raises
        ------
        NotConverged, InvalidParameter
            If not even the start can be simulated.
        """
        from scipy.optimize import least_squares

        members = tuple(members)
        arm = self.with_effects(members)
        coordinates = tuple(
            Coordinate(k, name, prior)
            for k, member in enumerate(members)
            for name, prior in member.priors_in(arm).items()
            if name in member.free
        )
        left, projection = self.eliminated(members)
        start = np.array([c.z(value_of(members[c.candidate].effect, c.name)) for c in coordinates])
        if not len(start):
            residual = self.residual(members)
            return Fit(
                members,
                (),
                start,
                arm,
                residual,
                projection.rest(residual),
                np.empty((len(residual), 0)),
                left,
                projection,
            )
        problem = _Problem(self, members, coordinates, projection)
        problem.raw(start)  # an error here is the caller's
        reach = np.array([REACH[c.prior.scale] for c in coordinates])
        start = np.clip(start, -0.99 * reach, 0.99 * reach)
        found = least_squares(
            problem.rows,
            start,
            problem.jacobian,
            bounds=(-reach, reach),
            x_scale=1.0,
            max_nfev=evaluations,
            ftol=tolerance * 1e-1,
            xtol=tolerance,
            gtol=1e-12,
        )
        z = found.x
        residual, slopes = problem.raw(z), problem.differences(z)
        fitted = problem.members_at(z)
        return Fit(
            fitted,
            coordinates,
            z,
            self.with_effects(fitted),
            residual,
            projection.rest(residual),
            slopes,
            left,
            projection,
            bool(found.status > 0),
        )

    def with_effects(self, members: Sequence[Candidate]) -> Arm:
        """The nominal model with effects, and with what they need."""
        arm = self.start
        present = {member.place for member in members}
        for member in members:
            if member.needs is not None and (member.needs.name, member.needs.at) not in present:
                arm = arm.with_effect(member.needs)
        springs_first = sorted(members, key=lambda m: m.name not in ("joint_compliance", "base_compliance"))
        for member in springs_first:
            arm = arm.with_effect(member.effect)
        return arm


class _Problem:
    """Rows and derivatives of (1), with the last evaluations kept."""

    def __init__(
        self,
        fitter: Fitter,
        members: tuple[Candidate, ...],
        coordinates: tuple[Coordinate, ...],
        projection: Projection,
    ) -> None:
        self.fitter, self.members = fitter, members
        self.coordinates, self.projection = coordinates, projection
        self._raw: dict[bytes, Floats] = {}
        self._slopes: dict[bytes, Floats] = {}
        self._differences: dict[bytes, Floats] = {}
        self._last: Floats | None = None

    def members_at(self, z: Floats) -> tuple[Candidate, ...]:
        """The effects with these parameters."""
        found = list(self.members)
        for k, member in enumerate(found):
            values = {
                c.name: c.value(float(x))
                for c, x in zip(self.coordinates, z, strict=True)
                if c.candidate == k
            }
            found[k] = replace(member, effect=member.effect.with_parameters(values))
        return tuple(found)

    def _arm(self, z: Floats) -> Arm | None:
        try:
            return self.fitter.with_effects(self.members_at(z))
        except InvalidParameter:
            return None

    def raw(self, z: Floats) -> Floats:
        """Residuals of the model."""
        key = z.tobytes()
        if key not in self._raw:
            self._raw[key] = self.fitter.residual(self.members_at(z))
        return self._raw[key]

    def rows(self, z: Floats) -> Floats:
        """Rows of (1); where nothing can be simulated, the sum is so large that the step is taken back."""
        try:
            rest = self.projection.rest(self.raw(z))
        except (NotConverged, InvalidParameter):
            return np.full(len(self.fitter.observed) + self.projection.added + len(z), 1e4)
        return np.concatenate([rest, self._prior(z)[0]])

    def slopes_at(self, z: Floats) -> Floats:
        """Derivatives of the residuals by z, eq. (2) where that is enough."""
        key = z.tobytes()
        if key not in self._slopes:
            self._slopes[key] = found if (found := self._updated(z)) is not None else self.differences(z)
        self._last = z.copy()
        return self._slopes[key]

    def _updated(self, z: Floats) -> Floats | None:
        """Eq. (2) from the last derivatives; None if there are none or they foretold too little.

        A single difference costs as little.
        """
        if self._last is None or len(z) == 1:
            return None
        slopes, dz = self._slopes[self._last.tobytes()], z - self._last
        step = self.raw(z) - self.raw(self._last)
        missed = step - slopes @ dz
        if float(missed @ missed) > FORETOLD**2 * float(step @ step):
            return None
        updated: Floats = slopes + np.outer(missed, dz / float(dz @ dz))  # eq. (2)
        return updated

    def differences(self, z: Floats) -> Floats:
        """Derivatives from finite steps, forward or backward where there is room."""
        key = z.tobytes()
        if key not in self._differences:
            exact = self._exact(z)
            if exact is not None:
                self._differences[key] = exact
                return exact
            here = self.raw(z)
            ahead = [z + STEP * row for row in np.eye(len(z))]
            self.fitter.observed.prepare(arm for there in ahead if (arm := self._arm(there)) is not None)
            self._differences[key] = np.stack([self._column(z, k, here) for k in range(len(z))], axis=1)
        return self._differences[key]

    def _exact(self, z: Floats) -> Floats | None:
        """The same of laws without corners in poses, which have derivatives of their own."""
        names = [(self.members[c.candidate], c.name) for c in self.coordinates]
        arm = self._arm(z)
        if arm is None or any(member.name in CORNERS for member, _ in names):
            return None
        keys = [f"effects.{member.name}.{member.at}.{name}" for member, name in names]
        found = self.fitter.observed.pose_slopes(arm, keys)
        slope = [c.slope(float(x)) for c, x in zip(self.coordinates, z, strict=True)]
        return None if found is None else found * slope

    def _column(self, z: Floats, k: int, here: Floats) -> Floats:
        for step in (STEP, -STEP):
            there = z.copy()
            there[k] += step
            try:
                found: Floats = (self.raw(there) - here) / step
            except (NotConverged, InvalidParameter):
                continue
            return found
        return np.zeros_like(here)

    def jacobian(self, z: Floats) -> Floats:
        """Derivatives of the rows."""
        return np.vstack([self.projection.rest(self.slopes_at(z)), np.diag(self._prior(z)[1])])

    def _prior(self, z: Floats) -> tuple[Floats, Floats]:
        """The priors' rows of (1) and their derivatives."""
        weak = np.array([1e-3 if c.prior.scale == "uniform" else 1 / 3 for c in self.coordinates])
        x = weak * z
        rows = np.sign(x) * np.sqrt(np.log1p(x**2))
        near = np.abs(x) < 1e-4  # where the row is x
        slopes = np.where(near, 1.0, x / (1 + x**2) / np.where(near, 1.0, rows))
        return rows, weak * slopes
