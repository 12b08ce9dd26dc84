"""Steps of Gauss and Newton in which effects, clocks, frames and nominal values move together.

A fit moves z through the full simulation, and the unknowns x to first order about where they were. Where
both act alike, such as the stiffness of a link and its modulus, what x does there is known too badly for z to
follow it along the valley of the least C, and fits repeated about themselves creep. With r, J_z = dr/dz, and
J_x = dr/dx of one and the same model,

    min over dz of  C(r + J_z dz) + sum_i ln(1 + (z_i + dz_i)^2/9),                                    (1)

where C eliminates x with J_x. About the model at z + dz and x + dx, with J_x of that one, z is then fitted:
what bends beside the straight step is mended where it costs least.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.fitting.coordinate import members_at, prior_rows
from flexarm.diagnosis.fitting.fit import Fit

if TYPE_CHECKING:
    from flexarm.diagnosis.fitting.fitter import Fitter


def evaluated(fit: Fit, fitter: Fitter) -> tuple[Fit, Fitter]:
    """A fit as (1) needs it, with all derivatives of one model, and the fitter about that."""
    if fitter.members != fit.members:
        fitter = fitter.about(fit)
    elif fit.projection is fitter.eliminated(fit.members)[1]:
        return fit, fitter
    return fitter.evaluated(fit.members), fitter


def stepped(
    fit: Fit, fitter: Fitter, anew: bool = True, part: float = 1.0, limit: float = inf
) -> tuple[Fit, Fitter]:
    """The fit after a step of (1), or a part of it, from an evaluated one, and the fitter that made it.

    Its derivatives by unknowns are taken `anew`, or kept where they foretell the step. A fit that would stay
    above the limit is not finished.

    Raises
    ------
    NotConverged, InvalidParameter
        If there is no such model.
    """
    dz = _least(fit)
    members = members_at(fit.members, fit.coordinates, fit.z + part * dz)
    ahead = replace(fit, members=members, residual=fit.residual + fit.slopes @ dz)  # where x is after dz
    about = fitter.about(ahead, part) if anew else fitter.towards(ahead, part)
    return about.fit(members, limit=limit, nearby=fit), about


def foretold(fit: Fit) -> float:
    """By how much the objective of an evaluated fit falls in a step, to first order."""
    dz = _least(fit)
    rest = fit.projection.rest(fit.residual + fit.slopes @ dz)
    ahead = float(rest @ rest) + float(np.sum(prior_rows(fit.coordinates, fit.z + dz)[0] ** 2))
    return objective(fit) - ahead


def objective(fit: Fit) -> float:
    """What (1) makes least."""
    return fit.cost + float(np.sum(prior_rows(fit.coordinates, fit.z)[0] ** 2))


def _least(fit: Fit) -> Floats:
    """dz of (1), cut where z would leave its bounds."""
    rows, slopes = prior_rows(fit.coordinates, fit.z)
    found = np.linalg.lstsq(
        np.vstack([fit.projection.rest(fit.slopes), np.diag(slopes)]),
        -np.concatenate([fit.projection.rest(fit.residual), rows]),
        rcond=None,
    )[0]
    bounds = np.array([c.bound for c in fit.coordinates])
    return np.asarray(np.clip(fit.z + found, -bounds, bounds) - fit.z)
