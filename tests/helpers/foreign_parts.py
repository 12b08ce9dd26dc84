"""Parts as other programs write them: in mm, t, s, N, with freedoms along each point's own axes."""

import numpy as np
from scipy.io import mmwrite
from scipy.linalg import block_diag
from scipy.sparse import coo_array
from scipy.spatial.transform import Rotation

POINTS = {"foot": 11, "hand": 7, "ear": 23}
FIRST_MODE = 101


CORD2 = """\
CORD2R         1       0   10.00   20.00   30.00  110.00   20.00  130.00
        -140.00  220.00   30.00
CORD2C*                2               1             5.0             6.0
*                    7.0            25.0             6.0             7.0
*                    5.0            86.0             7.0
$ a comment
"""


def axes_of_systems():
    """Axes of systems 1 and 2 of CORD2 by the rule in words: z from A to B, C in the x-z plane."""

    def axes(A, B, C):
        z = (B - A) / np.linalg.norm(B - A)
        x = (C - A) - z * (z @ (C - A))
        x /= np.linalg.norm(x)
        return np.column_stack([x, np.cross(z, x), z])

    first = axes(*np.array([[10.0, 20, 30], [110, 20, 130], [-140, 220, 30]]))
    inner = axes(*np.array([[5.0, 6, 7], [25, 6, 7], [5, 86, 7]]))
    return first, np.array([10.0, 20, 30]) + first @ [5.0, 6, 7], first @ inner


def write_grids(path, part, unit=1e-3):
    """GRID entries in mm: foot in the basic system, hand turned by system 1, ear cylindrical (system 2)."""
    lines = [CORD2]
    for (name, number), cd in zip(POINTS.items(), (0, 1, 2), strict=True):
        x, y, z = part.positions[part.interfaces.index(name)] / unit
        lines.append(f"GRID,{number},,{x:.12g},{y:.12g},{z:.12g},{cd}\n")
    path.write_text("SOL 103\nCEND\nBEGIN BULK\n" + "".join(lines) + "ENDDATA\n")
    return path


def local_axes(part):
    """Axes of the freedoms of the three points, as `write_grids` states them."""
    first, origin, second = axes_of_systems()
    x, y, _ = second.T @ (1e3 * part.positions[2] - origin)
    around = Rotation.from_euler("z", np.arctan2(y, x)).as_matrix()
    return [np.eye(3), first, second @ around]


def foreign(part, matrix, scale=1e3):
    """A matrix as another program has it: mm, t, s, along each point's axes; modes keep their unit mass."""
    A = block_diag(*(block_diag(a, a) for a in local_axes(part)), np.eye(part.n_modes))
    S = np.concatenate([np.tile([1e-3] * 3 + [1.0] * 3, 3), np.full(part.n_modes, 1e-3**0.5)])
    return scale * np.outer(S, S) * (A.T @ matrix @ A)  # energy 1 J = 1e3 N mm


def freedoms_of(part):
    """Point and component of every row, in the order of the part."""
    modes = [(FIRST_MODE + i, 0) for i in range(part.n_modes)]
    return [(p, c) for p in POINTS.values() for c in range(1, 7)] + modes


def market(directory, part, names=("stiffness", "mass", "damping")):
    """Matrices as Matrix Market files in mm."""
    files = []
    for name, matrix in zip(names, (part.stiffness, part.mass, part.damping), strict=False):
        files.append(directory / f"{name}.mtx")
        mmwrite(files[-1], coo_array(foreign(part, matrix)), precision=10, symmetry="symmetric")
    return files


def write_dmig(path, part, names=("KAAX", "MAAX", "BAAX")):
    """DMIG entries by pyyeti, the freedoms in no order."""
    import pandas as pd
    from pyyeti.nastran import bulk

    rows = np.random.default_rng(3).permutation(part.n_dof)
    freedoms = freedoms_of(part)
    index = pd.MultiIndex.from_tuples([freedoms[i] for i in rows], names=["id", "dof"])
    matrices = (foreign(part, m)[np.ix_(rows, rows)] for m in (part.stiffness, part.mass, part.damping))
    frames = (pd.DataFrame(matrix, index=index, columns=index) for matrix in matrices)
    bulk.wtdmig(str(path), dict(zip(names, frames, strict=True)))
    return path


def user_element(part, per_freedom=False):
    """The text of *SUBSTRUCTURE MATRIX OUTPUT; CalculiX (per freedom) names a point for each freedom."""
    freedoms = freedoms_of(part)
    points = [p for p, _ in freedoms] if per_freedom else list(POINTS.values())
    lines = ["**", "** GENERATION OF SUBSTRUCTURE", f"*USER ELEMENT,NODES= {len(points):10d},LINEAR"]
    lines += ["** ELEMENT NODES"]
    lines += ["**" + "".join(f"{p:10d}," for p in points[k : k + 11]) for k in range(0, len(points), 11)]
    lines += [f"{freedoms[0][1]:10d}"] if per_freedom else ["1, 2, 3, 4, 5, 6"]
    lines += [f"{i:10d},{c:10d}" for i, (_, c) in enumerate(freedoms, 1) if i > 1 and per_freedom]
    for kind, name in (("STIFFNESS", "stiffness"), ("MASS", "mass")):
        values = foreign(part, getattr(part, name))
        lines.append(f"*MATRIX,TYPE={kind}")
        for j in range(18):
            column = [f"{v:20.13e}" for v in values[: j + 1, j]]
            lines += [",".join(column[k : k + 4]) + "," for k in range(0, j + 1, 4)]
    return "\n".join(lines) + "\n"


def matrix_input(part, matrix, separator=", "):
    """Row point, component, column point, component, value: the lower triangle."""
    values, freedoms = foreign(part, matrix), freedoms_of(part)
    rows = ((i, j) for i in range(len(values)) for j in range(i + 1))
    return "\n".join(
        separator.join(map(str, (*freedoms[i], *freedoms[j], f"{values[i, j]:.12e}"))) for i, j in rows
    )


CUBE = np.array([[x, y, z] for x in (0, 100.0) for y in (0, 100.0) for z in (0, 100.0)])


def write_cube(directory):
    """A cube of 100 mm and 2.7 kg with three freedoms a corner, as CalculiX stores K, M and their order."""
    K = trussed(CUBE)
    write_storage(directory / "cube.sti", K)
    write_storage(directory / "cube.mas", 2.7e-3 / 8 * np.eye(24))
    order = (f"{i + 1}.{c}\n" for i in range(8) for c in (1, 2, 3))
    (directory / "cube.dof").write_text("".join(order))
    nodes = "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(CUBE, 1))
    (directory / "cube.inp").write_text(f"*HEADING\ncube\n*NODE, NSET=ALL\n{nodes}*ELEMENT\n1,1,2\n")
    return K


def trussed(points):
    """Springs of 1000 N/mm between all pairs of points: rigid motion strains none."""
    K = np.zeros((3 * len(points), 3 * len(points)))
    for i in range(len(points)):
        for j in range(i):
            n = (points[i] - points[j]) / np.linalg.norm(points[i] - points[j])
            at = np.concatenate([3 * i + np.arange(3), 3 * j + np.arange(3)])
            K[np.ix_(at, at)] += 1e3 * np.outer([*n, *-n], [*n, *-n])
    return K


def write_storage(path, matrix):
    rows = ((i, j) for j in range(len(matrix)) for i in range(j + 1) if matrix[i, j] != 0)
    path.write_text("".join(f"{i + 1} {j + 1} {matrix[i, j]:20.13e}\n" for i, j in rows))
