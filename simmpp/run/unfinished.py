"""How far a picture is at a moment of a run: progressive rendering, as one would watch it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.result import Result
from simmpp.workload.workload import Workload


def finished_roots(workload: Workload, result: Result, until_ps: int) -> NDArray[np.bool_]:
    """Which primary rays are finished by then with all their descendants: (n0,) bool.

    ``result`` is of a run with ``Recording.ends``.
    """
    if result.ray_ends_ps is None:
        raise ValueError("expected a run that recorded when its rays ended")
    last_ps = np.zeros(workload.n_primaries, np.int64)
    np.maximum.at(last_ps, workload.pixels, result.ray_ends_ps)
    return last_ps <= until_ps
