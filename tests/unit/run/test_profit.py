"""Profits over the reference, with nothing over nothing and something over nothing."""

import math

import numpy as np
import pytest

from simmpp.common.errors import ConfigError
from simmpp.engine.result import Result
from simmpp.run.profit import profits, ratio


def result(policy: str, makespan_ps: int, requests: int) -> Result:
    none = np.zeros(2, np.int64)
    return Result(
        policy=policy, engine="simpy", makespan_ps=makespan_ps,
        messages_by_kind=(requests, requests, 0, 0), parts_by_kind=(requests, requests, 0, 0),
        messages_received=2 * requests, bytes_sent=0,
        rays=0, tests=0, rays_sent=0, compute_ps=none, communication_ps=none, waiting_ps=none,
        service_ps=none,
        pe_peak_rays=none, pe_peak_bytes=none, pe_peak_object_bytes=none, events=0,
    )  # fmt: skip


def test_above_one_is_better_than_the_reference() -> None:
    found = profits([result("ray", 50, 5), result("object", 100, 20), result("replicated", 25, 0)])
    assert [(p.policy, p.time, p.messages) for p in found] == [
        ("ray", 2.0, 4.0),
        ("object", 1.0, 1.0),
        ("replicated", 4.0, math.inf),
    ]


def test_nothing_over_nothing_is_no_profit() -> None:
    assert (ratio(0, 0), ratio(3, 0), ratio(0, 3)) == (1.0, math.inf, 0.0)


def test_without_the_reference_there_is_no_profit() -> None:
    with pytest.raises(ConfigError, match="no result of the reference 'object'; there are: ray"):
        profits([result("ray", 1, 1)])
