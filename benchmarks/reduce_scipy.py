"""The ring reduced with SciPy: as usually written, and with skill.

As usually written: `splu` as it comes for the interface shapes, `eigsh` in shift-invert mode, which factors
again. With skill: one factor for both, in the ordering for symmetric matrices and without pivoting away
from the diagonal, and eigenvalues no sharper than flexarm's.
"""

import numpy as np
import scipy
from ring import MODES, Part
from scipy.sparse.linalg import LinearOperator, eigsh, splu

TOLERANCE = 1e-7
"""On a residual in parts of the eigenvalue, as flexarm's Lanczos method has it."""


def reduce(part: Part, skilled):
    """Frequencies [Hz], reduced K and M of equation (1) in ring.py."""
    motions, inner = part.face_motions(), part.inner()
    K_ii, M_ii = part.K[inner][:, inner].tocsc(), part.M[inner][:, inner].tocsc()
    if skilled:
        factor = splu(
            K_ii, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True}
        )
        inverse = LinearOperator(K_ii.shape, matvec=factor.solve, dtype=float)
        more = {"OPinv": inverse, "tol": TOLERANCE}
    else:
        factor, more = splu(K_ii), {}
    shapes = np.hstack([motions, np.zeros((len(motions), MODES))])
    shapes[inner, : motions.shape[1]] = -factor.solve((part.K @ motions)[inner])
    values, shapes[inner, motions.shape[1] :] = eigsh(K_ii, MODES, M_ii, sigma=0.0, **more)
    return np.sqrt(values) / (2 * np.pi), shapes.T @ (part.K @ shapes), shapes.T @ (part.M @ shapes)


def version():
    """Of SciPy."""
    return {"scipy": scipy.__version__}
