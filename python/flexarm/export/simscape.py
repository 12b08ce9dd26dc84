"""Super-elements for the block Reduced Order Flexible Solid of Simscape Multibody, as a MAT file in SI units.

    origins      (n, 3)      interface frames' positions in the part's frame [m]
    quaternions  (n, 4)      their orientations, scalar first
    K, M, C      (dof, dof)  matrices [N/m, kg, N s/m and those of rotations]
    interfaces, frequency_hz, name

The block takes, for each frame, translations then rotations along the reference frame's axes, and the modes
last: the order of a super-element. Source: MathWorks, Simscape Multibody, Reduced Order Flexible Solid.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from flexarm.output import write_file
from flexarm.superelement import SuperElement


def write_simscape(element: SuperElement, path: Path) -> list[Path]:
    """Write the MAT file (level 5); return it."""
    from scipy.io import savemat
    from scipy.spatial.transform import Rotation

    cells = np.empty((element.n_interfaces, 1), dtype=object)
    cells[:, 0] = element.interfaces
    image = BytesIO()
    savemat(
        image,
        {
            "name": element.name,
            "interfaces": cells,
            "origins": element.positions,
            "quaternions": np.roll(Rotation.from_matrix(element.rotations).as_quat(), 1, axis=1),
            "K": element.stiffness,
            "M": element.mass,
            "C": element.damping,
            "frequency_hz": element.frequency_hz[:, None],
        },
    )
    write_file(path, image.getbuffer())
    return [path]
