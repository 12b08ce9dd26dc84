"""`flexarm reproduce`: the paper's figures and claims."""

from __future__ import annotations

from pathlib import Path

from flexarm.cli.options import Force, Out
from flexarm.cli.progress import progress


def reproduce(out: Out = Path("results"), force: Force = False) -> None:
    """Reproduce the figures and claims of the paper.

    Meshes and reduces the hinge's solid parts, simulates, and writes figures 4, 6, 7, 8, 9 and 10 as
    figure-NN.png, .pdf and .csv, summary.json and index.html; the model with its super-elements beside them.
    "Measured" curves are a virtual measurement: the authors' data are not public.

        flexarm reproduce --out results
    """
    from flexarm.reproduction import reproduce as make

    with progress() as tell:
        make(out=out, force=force, progress=tell)
    print(f"written to {out}: open {out / 'index.html'}")
