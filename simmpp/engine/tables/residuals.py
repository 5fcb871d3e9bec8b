"""How soon little is left to be done, of tables whose rounds say what is left after each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

LEFT = {
    "residual_tenth_ps": 0.1,
    "residual_hundredth_ps": 0.01,
    "residual_thousandth_ps": 0.001,
}
"""Columns of rows, and the share that is left then at most."""


def times_of_residuals(
    residuals: NDArray[np.float64], round_ends_ps: NDArray[np.int64]
) -> dict[str, int]:
    """When no more than each share is left, by column; of what is not reached, nothing.

    Parameters
    ----------
    residuals : (rounds,) or none, share that is left after each round and all before it
    round_ends_ps : (rounds,) when each was over, negative for never; later ones may be sooner
    """
    times = {}
    for column, share in LEFT.items():
        enough = np.flatnonzero(residuals <= share)
        if len(enough):
            ends = round_ends_ps[: enough[0] + 1]
            if (ends >= 0).all():
                times[column] = int(ends.max())
    return times
