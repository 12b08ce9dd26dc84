"""Damaged matrices and points end in an error that names the file, never in another one."""

import numpy as np
import pytest
from foreign_parts import (
    POINTS,
    foreign,
    market,
    matrix_input,
    user_element,
    write_cube,
    write_dmig,
    write_grids,
)
from parts import frame_part

from flexarm import InvalidParameter, SuperElement, accept_matrices

PART = frame_part(n_modes=0)
TIMES = 60


def market_files(directory):
    K, M = market(directory, PART, ("K", "M"))
    return K, {"mass_matrix": M, "order": "11 7 23"}


def user_files(directory):
    (directory / "sub.mtx").write_text(user_element(PART))
    return directory / "sub.mtx", {}


def input_files(directory):
    for name, matrix in (("K", PART.stiffness), ("M", PART.mass)):
        (directory / f"{name}.mtx").write_text(matrix_input(PART, matrix))
    return directory / "K.mtx", {"mass_matrix": directory / "M.mtx"}


def dmig_files(directory):
    return write_dmig(directory / "part.pch", PART), {}


def op4_files(directory):
    from pyyeti.nastran import op4

    values = [foreign(PART, matrix) for matrix in (PART.stiffness, PART.mass)]
    op4.write(str(directory / "part.op4"), ["kaax", "maax"], values, binary=False)
    return directory / "part.op4", {"order": "11 7 23"}


def storage_files(directory):
    write_cube(directory)
    ends = {"left": [1, 2, 3, 4], "right": [5, 6, 7, 8]}
    return directory / "cube.sti", {"grids": directory / "cube.inp", "interfaces": ends}


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """Cut off, or with a piece overwritten, removed or doubled."""
    at, length = int(rng.integers(len(content))), int(rng.integers(1, 40))
    noise = bytes(rng.choice(np.frombuffer(b"0123456789.,-+eE* \nXD\xff\x00", np.uint8), length))
    return [
        content[:at],
        content[:at] + noise + content[at + length :],
        content[:at] + content[at + length :],
        content[: at + length] + content[at:],
    ][int(rng.integers(4))]


@pytest.mark.parametrize(
    "files", [market_files, user_files, input_files, dmig_files, op4_files, storage_files]
)
@pytest.mark.parametrize("which", ["matrix", "grids"])
def test_damaged_files_are_read_or_refused(tmp_path, files, which):
    stiffness, given = files(tmp_path)
    grids = write_grids(tmp_path / "part.bdf", PART)
    options = {"grids": grids, "interfaces": POINTS, "unit": "mm", **given}
    target = stiffness if which == "matrix" else options["grids"]
    content = target.read_bytes()
    rng = np.random.default_rng(7)
    accept_matrices(stiffness, **options)
    refused = 0
    for _ in range(TIMES):
        target.write_bytes(damaged(content, rng))
        try:
            accept_matrices(stiffness, **options)
        except InvalidParameter as error:
            assert str(error)
            refused += 1
    assert refused > TIMES / 10


def test_damaged_super_elements_are_read_or_refused(tmp_path):
    PART.save(tmp_path / "part.nc")
    content = (tmp_path / "part.nc").read_bytes()
    rng = np.random.default_rng(7)
    refused = 0
    for _ in range(TIMES):
        (tmp_path / "part.nc").write_bytes(damaged(content, rng))
        try:
            SuperElement.load(tmp_path / "part.nc")
        except InvalidParameter:
            refused += 1
    assert refused > TIMES / 4
