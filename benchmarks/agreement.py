"""Whether the codes found the same reduced part.

    max |f_a/f_b - 1|,   max |A_ij - B_ij|/sqrt(B_ii B_jj)                                            (1)

over the frequencies of the inner modes, and over the interface freedoms of K and M. Inner modes themselves
may differ by sign and, where a ring has two of one frequency, by a rotation.
"""

import numpy as np

INTERFACE = slice(0, 12)


def worst(files):
    """Largest differences (1) of any result from the first."""
    results = [_read(file) for file in files]
    first = results[0]
    found = {"frequencies": 0.0, "reduced K": 0.0, "reduced M": 0.0}
    for other in results[1:]:
        found["frequencies"] = max(
            found["frequencies"], float(np.abs(other["frequency"] / first["frequency"] - 1).max())
        )
        for name, key in (("reduced K", "stiffness"), ("reduced M", "mass")):
            found[name] = max(found[name], difference(other[key], first[key]))
    return found


def difference(A, B):
    """Of two matrices by (1), in the interface freedoms."""
    A, B = A[INTERFACE, INTERFACE], B[INTERFACE, INTERFACE]
    scale = np.sqrt(np.diag(B))
    return float((np.abs(A - B) / np.outer(scale, scale)).max())


def _read(file):
    with np.load(file) as arrays:
        return dict(arrays)
