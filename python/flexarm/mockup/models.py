"""The models of the mock-up that ship with flexarm.

Table 1 of the paper prints a section area of 5.92e-5 m2 beside a wall of 3.25e-3 m and I = 2.37e-7 m4, which
give an outside diameter of 60.24 mm and an area of 5.82e-4 m2. Both are there by name.
"""

from __future__ import annotations

from pathlib import Path

from flexarm.arm import Arm
from flexarm.errors import InvalidParameter

FOLDER = Path(__file__).parent
PARAMETER_SETS = {"consistent": "model.toml", "printed": "model-printed-area.toml"}
"""Parameter sets of Table 1, files in `FOLDER`: the area that wall and I give (default), and as printed."""


def model(parameters: str = "consistent") -> Arm:
    """Return the model that is compared with the mock-up.

    Parameters
    ----------
    parameters : {"consistent", "printed"}
        Section area 5.82e-4 m2 (rod 13.7 kg) or, as printed, 5.92e-5 m2 (rod 1.4 kg).

    Examples
    --------
    >>> flexarm.mockup.model().link("tube").section  # doctest: +SKIP
    """
    if parameters not in PARAMETER_SETS:
        raise InvalidParameter(f"must be one of {', '.join(PARAMETER_SETS)}, got {parameters!r}")
    return Arm.from_toml(FOLDER / PARAMETER_SETS[parameters])


def mock_up() -> Arm:
    """Return the model behind the virtual measurement, with its controller."""
    return Arm.from_toml(FOLDER / "mockup.toml")
