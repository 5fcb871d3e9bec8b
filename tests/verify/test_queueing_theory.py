"""Links and ports as the single server of queueing theory: mean waits, within their intervals.

Poisson departures of equal messages to one port are an M/D/1 queue (a mean wait of rho T /
(2 (1 - rho)), Pollaczek and Khinchine), those of exponential sizes an M/M/1 queue (rho T /
(1 - rho)); T is the mean time of a message, rho the share of the time that the port is busy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import MACHINE
from numpy.typing import NDArray
from oracles.hop_by_hop import Sent
from scipy import stats
from traffic import arrivals_ps

SHAPE = (3, 3, 3)
NEIGHBOURS = (1, 2, 3, 6, 9, 18)
"""Of PE 0, each over a link of its own."""
T_PS = 10**6
MESSAGES, BATCHES = 200_000, 40
LATENCY_PS, HOP_PS = 2 * 10**6, 50_000

Times = NDArray[np.int64]
Draw = Callable[[np.random.Generator, int], Times]


def equal_sizes(rng: np.random.Generator, n: int) -> Times:
    return np.full(n, T_PS)


def exponential_sizes(rng: np.random.Generator, n: int) -> Times:
    return np.rint(rng.exponential(T_PS, n)).astype(np.int64)


def waits_ps(rho: float, sources: tuple[int, ...], sizes: Draw, destination: int) -> Times:
    """What each of many messages waits on its way, of a stream that keeps a port busy for rho."""
    rng = np.random.default_rng(19980101)
    departs_ps = np.rint(np.cumsum(rng.exponential(T_PS / rho, MESSAGES))).astype(np.int64)
    senders = rng.choice(sources, MESSAGES)
    busy_ps = sizes(rng, MESSAGES)
    machine = replace(MACHINE, shape=SHAPE, latency_ps=LATENCY_PS, hop_latency_ps=HOP_PS)
    columns = zip(departs_ps, senders, range(MESSAGES), busy_ps, strict=True)
    traffic = [Sent(at, pe, n, destination, busy) for at, pe, n, busy in columns]
    return arrivals_ps(machine, traffic) - departs_ps - LATENCY_PS - HOP_PS - busy_ps


def mean_within(waits: Times) -> tuple[float, float]:
    """Mean, and half of its 95 % interval by the means of batches; the first is left out."""
    means = waits.reshape(BATCHES, -1).mean(axis=1)[1:]
    t = stats.t.ppf(0.975, len(means) - 1)
    return float(means.mean()), float(t * means.std(ddof=1) / np.sqrt(len(means)))


@pytest.mark.parametrize("rho", [0.3, 0.6, 0.8])
def test_equal_messages_from_one_pe_wait_as_in_m_d_1(rho: float) -> None:
    assert_waits(waits_ps(rho, (1,), equal_sizes, 0), rho * T_PS / (2 * (1 - rho)))


@pytest.mark.parametrize("rho", [0.3, 0.6, 0.8])
def test_equal_messages_from_many_pes_wait_as_in_m_d_1(rho: float) -> None:
    # What waits for its own port or link would wait for the ejection port otherwise
    assert_waits(waits_ps(rho, NEIGHBOURS, equal_sizes, 0), rho * T_PS / (2 * (1 - rho)))


@pytest.mark.parametrize("rho", [0.3, 0.6, 0.8])
def test_messages_of_exponential_size_wait_as_in_m_m_1(rho: float) -> None:
    assert_waits(waits_ps(rho, (1,), exponential_sizes, 0), rho * T_PS / (1 - rho))


def assert_waits(waits: Times, expected_ps: float) -> None:
    """The mean is the theory's, within an interval that could tell it from others."""
    mean_ps, half_ps = mean_within(waits)
    assert half_ps < 0.12 * expected_ps
    assert abs(mean_ps - expected_ps) < half_ps
