"""What can't be combined with the rays of tables: rounds, and objects with results."""

from __future__ import annotations

from simmpp.common.errors import ConfigError
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


def require_known(workload: Workload, placement: Placement, policy: PolicyParameters) -> None:
    """Raise ConfigError, with the key, for what no engine simulates."""
    if policy.steals and workload.n_rounds > 1 and placement.window > 1:
        problem = f"value {policy.steal}: expected none where several rounds are there together"
        raise ConfigError(problem, where="policy.steal")
