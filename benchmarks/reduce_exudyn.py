"""The ring reduced by EXUDYN's own FEMinterface, as its manual recommends: RBE2 interfaces, sparse solver.

Both faces keep their six freedoms, as in the other codes. EXUDYN's rotation shapes turn the other way; the
sign is put right after the clock has stopped, and the projection of K and M, which EXUDYN leaves to its
object in the multibody model, is not counted either.
"""

import contextlib
import io

import exudyn
import numpy as np
from exudyn.FEM import FEMinterface, HCBstaticModeSelection
from ring import MODES, Part


def prepare(part: Part):
    """Nodes and matrices, as its readers of Abaqus and Ansys files leave them."""
    fem = FEMinterface()
    fem.nodes = {"Position": part.points}
    fem.stiffnessMatrix, fem.massMatrix = part.K.tocsr(), part.M.tocsr()
    return fem


def compute(fem, part: Part):
    """Interface shapes and modes; they stay in the FEMinterface."""
    with contextlib.redirect_stdout(io.StringIO()):
        fem.ComputeHurtyCraigBamptonModes(
            boundaryNodesList=[points.tolist() for points in part.faces],
            nEigenModes=MODES,
            useSparseSolver=True,
            computationMode=HCBstaticModeSelection.RBE2,
            excludeRigidBodyMotion=False,
        )


def result(fem, part: Part):
    """Frequencies [Hz], reduced K and M with rotations about +x, +y, +z."""
    shapes = fem.modeBasis["matrix"].copy()
    for first in range(3, 6 * len(part.faces), 6):
        shapes[:, first : first + 3] *= -1
    frequencies = np.sqrt(np.sort(fem.eigenValues)) / (2 * np.pi)
    return frequencies, shapes.T @ (part.K @ shapes), shapes.T @ (part.M @ shapes)


def version():
    """Of EXUDYN."""
    return {"exudyn": getattr(exudyn, "__version__", None) or exudyn.config.Version()}
