"""Time of one PE in one step, for the two classical dataflows (Nebel 1998, section 3.2).

As printed, the time of ray dataflow, TC(i, k), has "T_receipt (nb - 1) + T_unpack_ray sum_j r(j, i,
k)" several times over. By the algorithm of section 3.1 (step 4b: "each processor sends only one
message to each of the other processors") a PE receives nb - 1 messages per step and unpacks each
ray once, so the term counts once, as the mirror of the sending term. The step is called k here
everywhere, and i, j are PEs (the printed formulas call the step j and a PE k); zeta and xi of
equation (1) are one variable.

Functions take arrays that broadcast, of integers or floats, and return what these give: with
integers they are exact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.model.costs import Costs

Array = NDArray[Any]


def ray_dataflow_ps(
    costs: Costs, tests: Array, ended: Array, messages: Array | int, packing: Array
) -> Array:
    """TC(i, k) of each PE and step.

    ``tests`` is n(i, k) after the rays have moved: equation (2), all r(j, i, k) with j = i. Each of
    ``messages`` is one that is sent and one that is received: nb - 1. ``packing`` is the time that
    rays are packed and unpacked: T_pack_ray sum_j r(i, j, k) + T_unpack_ray sum_j r(j, i, k).
    """
    computing = tests * costs.ray + ended * costs.deletion
    return np.asarray(computing + messages * costs.startup + packing)


def object_dataflow_ps(
    costs: Costs, tests: Array, ended: Array, asked: Array, served: Array
) -> Array:
    """TO(i, k) of each PE and step.

    ``tests`` is n(i, k) of the rays that stay on the PE. ``asked`` is sum_j r(i, j, k), one request
    and one object each; ``served`` is sum_j r(j, i, k).
    """
    asking = costs.sending + costs.pack_request + costs.receipt + costs.unpack_object
    serving = costs.sending + costs.pack_object + costs.receipt + costs.unpack_request
    computing = tests * costs.ray + ended * costs.deletion
    return np.asarray(computing + asking * asked + serving * served)


def makespan(times: Array) -> Array:
    """The sum over steps of the slowest PE's time; ``times`` is (K, ..., nb)."""
    return np.asarray(times.max(axis=-1).sum(axis=0))
