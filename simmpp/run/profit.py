"""The paper's two measures: how much better a policy is than object dataflow.

Source: Nebel 1998, section 4 (figures 3 to 5).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.validate import require_kind
from simmpp.engine.result import Result
from simmpp.policy.parameters import REFERENCE


@documented
@dataclass(frozen=True)
class Profit:
    """What one policy gains over the reference; above 1 it is better."""

    policy: str
    """Its label or name."""
    time: float
    """Makespan of the reference / makespan of the policy."""
    messages: float
    """Messages of the reference / messages of the policy."""


def ratio(reference: int, value: int) -> float:
    """reference / value; nothing over nothing is 1, something over nothing is infinite."""
    if value:
        return reference / value
    return math.inf if reference else 1.0


def speedup(row: Mapping[str, Any]) -> float:
    """T(1) / makespan of a row of ``results.csv``: one PE that holds all does only compute."""
    return ratio(row.get("work_ps") or row["compute_ps"], row["makespan_ps"])


def efficiency(row: Mapping[str, Any]) -> float:
    """Speed-up / PEs or, where their speeds differ, bound / makespan."""
    work_ps, bound_ps, nb = row.get("work_ps"), row.get("bound_ps"), row["processors"]
    if work_ps and bound_ps and bound_ps != -(-work_ps // nb):
        return ratio(bound_ps, row["makespan_ps"])
    return speedup(row) / nb


def profits(results: Sequence[Result], reference: str = REFERENCE) -> tuple[Profit, ...]:
    """Time and message profit of each result over the one whose policy is ``reference``.

    Raises ConfigError if there is none.
    """
    require_kind("results", results, Sequence)
    for result in results:
        require_kind("results", result, Result)
    base = next((result for result in results if result.policy == reference), None)
    if base is None:
        known = ", ".join(result.policy for result in results)
        raise ConfigError(
            f"reference: no result of the reference {reference!r}; there are: {known}"
        )
    return tuple(
        Profit(
            result.policy,
            ratio(base.makespan_ps, result.makespan_ps),
            ratio(base.messages, result.messages),
        )
        for result in results
    )
