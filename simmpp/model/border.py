"""Where the winner changes between ray and object dataflow: the border of the paper's figure 2."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from simmpp.model.analytical import Makespans
from simmpp.model.costs import Costs

Floats = NDArray[np.float64]
PROCESSORS = (8, 16, 32, 64, 128, 256, 512, 1024)
FRACTIONS = (
    Fraction(1, 64),
    *(Fraction(n, 100) for n in (3, 5, 10, 15, 20, 30, 40, 50, 60, 70, 80, 90, 100)),
)
"""The grid of the claims, where a configuration has no axes of its own."""
RAY, TIE, OBJECT = -1, 0, 1
SAID = {
    "F2a": "object dataflow is best when each PE holds a large part of the scene, ray dataflow "
    "when a small part",
    "F2b": "more processors favour object dataflow",
}
"""What the paper says of its figure 2, by the name of the claim."""


@dataclass(frozen=True)
class ModelVerdict:
    """What a claim's predicate says of a grid."""

    claim: str
    holds: bool
    simulated: str
    """What was found instead, or how clearly it holds."""


def winners(times: Makespans) -> NDArray[np.int8]:
    """RAY, OBJECT or TIE for each point: (B, X) int8."""
    return np.sign(times.ratio - 1.0).astype(np.int8)


def border_terms(costs: Costs) -> tuple[float, float]:
    """M and S of the border without imbalance, x = 1 - nb (nb - 1) M / (n S), at which TC = TO.

    Both dataflows compute the same; with n = mean over the steps of all rays of the machine,
    TC = TO where (1 - x) n / nb S = (nb - 1) M: S is what a ray saves that is sent and not served,
    the startups and packing of a request and its object, sent and received, less a ray's packing
    and unpacking; M is the startups and the fixed packing of a message of rays. So T_ray has no
    part in it. With packing that is negligible, S = 2 M: the border is where a message holds half
    a ray. Where a ray costs as much to pack as asking costs in all, S <= 0, object dataflow always
    wins.
    """
    asking = costs.pack_request + costs.unpack_request + costs.pack_object + costs.unpack_object
    message = costs.startup + costs.pack_message + costs.unpack_message
    return message, 2 * costs.startup + asking - costs.pack_ray - costs.unpack_ray


def borders(times: Makespans) -> Floats:
    """The x at which the winner first changes, log-interpolated on the ratio TC / TO: (B,).

    NaN where one dataflow wins at every x of the grid; ties are no change.
    """
    changes = np.full(len(times.processors), np.nan)
    for row, ratios in enumerate(np.log(times.ratio)):
        known = np.flatnonzero(ratios)
        for left, right in pairwise(known):
            if ratios[left] * ratios[right] < 0:
                weight = ratios[left] / (ratios[left] - ratios[right])
                x = times.fractions
                changes[row] = x[left] + weight * (x[right] - x[left])
                break
    return changes


def claims(times: Makespans) -> tuple[ModelVerdict, ModelVerdict]:
    """F2a: at every nb with a change, the winner changes once over x, from ray to object dataflow.
    F2b: the x of the change does not increase with nb.

    A grid without a change bears out neither.
    """
    return _changes_once(times), _never_rises(times)


def _changes_once(times: Makespans) -> ModelVerdict:
    changing, wrong = [], []
    for nb, row in zip(times.processors.tolist(), winners(times), strict=True):
        decided = row[row != TIE]
        changes = decided[np.flatnonzero(np.diff(decided)) + 1].tolist()
        if changes:
            changing.append(nb)
        if changes not in ([], [OBJECT]):
            wrong.append(nb)
    text = f"changes at nb = {_listed(changing)}" if changing else "no change at any nb"
    text += f"; not once, from ray to object, at nb = {_listed(wrong)}" if wrong else ""
    return ModelVerdict("F2a", bool(changing) and not wrong, text)


def _never_rises(times: Makespans) -> ModelVerdict:
    at = borders(times)
    changing = np.isfinite(at)
    steps = np.diff(at[changing][np.argsort(times.processors[changing])])
    pairs = zip(times.processors[changing].tolist(), at[changing].tolist(), strict=True)
    text = ", ".join(f"x = {x:.3g} at nb = {nb}" for nb, x in pairs) or "no change at any nb"
    return ModelVerdict("F2b", bool(changing.sum() > 1 and (steps <= 0).all()), text)


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers))
