"""Records of so few poses that an outlier among them would not be found, which a person should know."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexarm.comparison.pose_outliers import LEAST_POSES

if TYPE_CHECKING:
    from flexarm.comparison.subject import Subject


def remarks_on_few_poses(subjects: Mapping[str, Subject]) -> Iterator[str]:
    """A sentence for each signal of a static record that holds values in too few poses."""
    for name, subject in subjects.items():
        for signal in subject.evidence.values():
            if signal.pose is None:
                continue
            count = len(np.unique(signal.pose[signal.valid]))
            if count < LEAST_POSES:
                many = f"{name}: {signal.name} holds {count} pose{'s' * (count > 1)}"
                yield f"{many}; outliers are looked for among {LEAST_POSES} or more"
