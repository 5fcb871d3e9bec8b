"""How sure: shares of a Bayesian bootstrap over seeds that all candidates have in common.

Source: Rubin 1981, The Bayesian bootstrap: weights of the seeds are drawn from a flat Dirichlet
distribution. Few seeds spread less than what they are drawn from, so deviations from the mean are
made larger by sqrt((n + 1) / (n - 1)): then weighted means have the variance of the mean.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import key

DRAWS = 4000
"""A share of them is known to 0.8 % at most."""
LEAST_SEEDS = 8
"""No probability is told from fewer."""

Floats = NDArray[np.float64]


def weighted_means(costs: Sequence[Sequence[float]]) -> Floats:
    """Means of each candidate's costs over the seeds in every draw: (candidates, DRAWS).

    ``costs`` has a row of as many seeds for each; infinite ones stay so.
    """
    table = np.asarray(costs, np.float64)
    n = table.shape[1]
    weights = _weights(n)
    with np.errstate(invalid="ignore"):
        mean = table.mean(axis=1, keepdims=True)
        around = (table - mean) * np.sqrt((n + 1) / max(1, n - 1))
        means = mean + around @ weights.T
    return np.where(np.isfinite(means), means, np.inf)


def _weights(n: int) -> Floats:
    """(DRAWS, n), each row with the sum 1."""
    draws = np.random.Generator(np.random.Philox(key(n, "advise")))
    exponential = draws.standard_exponential((DRAWS, n))
    return exponential / exponential.sum(axis=1, keepdims=True)
