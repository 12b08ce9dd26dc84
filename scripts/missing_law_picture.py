"""Draw each kind of a missing law for docs/missing_law.md: python scripts/missing_law_picture.py"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests" / "helpers"))
import hidden_causes  # noqa: E402
from hidden_pendulum import Study  # noqa: E402

from flexarm.report.evidence_figures import draw_law  # noqa: E402
from flexarm.report.files import style  # noqa: E402

CAUSES = {
    "a bearing that rubs": hidden_causes.rubbing(),
    "a cable that drags": hidden_causes.cable(),
    "softer after 9 s": hidden_causes.softer_after(9.0),
    "a hinge that warms": hidden_causes.warming(),
    "gusts": hidden_causes.gusts(np.random.default_rng(3)),
    "loose coupling": hidden_causes.loose(),
}


def main() -> None:
    """Infer the law of each cause and draw the most probable one."""
    import matplotlib.pyplot as plt

    with style():
        figure, axes = plt.subplots(2, 3, figsize=(9.0, 5.0), layout="constrained")
        for ax, (title, hidden) in zip(axes.flat, CAUSES.items(), strict=True):
            law = Study.of(hidden.cause, 1).laws().curves[0]
            draw_law(ax, law)
            ax.set_title(f"{title}: {law.kind}")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.savefig(ROOT / "docs" / "figures" / "missing-laws.png", dpi=110)


if __name__ == "__main__":
    main()
