"""Ill input, damaged files, wrong calls, kills and random models, tried by the thousand.

A campaign makes numbered cases from a seed. A case runs in a child process with limits of its own, and what
comes out is classified (outcome.py). `python -m torture --help`, in the folder tests, says how to run them.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))
