"""What can't be combined with the rays of tables: rounds, and objects with results."""

from __future__ import annotations

from simmpp.common.errors import ConfigError
from simmpp.engine.tables.tallies import reduction_of, sends_deposits
from simmpp.machine.collective import barrier_ps
from simmpp.machine.limits import CLOCK_LIMIT_PS, MOST_BYTES, beyond_the_clock
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


def require_known(
    workload: Workload, machine: Machine, placement: Placement, policy: PolicyParameters
) -> None:
    """Raise ConfigError, with the key, for what no engine simulates."""
    if policy.steals and workload.n_rounds > 1 and placement.window > 1:
        problem = f"value {policy.steal}: expected none where several rounds are there together"
        raise ConfigError(problem, where="policy.steal")
    if sends_deposits(workload, placement):
        beside = "islands" if placement.islands > 1 else ""
        beside = "a memory.capacity" if placement.capacity is not None else beside
        if beside:
            problem = f"value send: expected reduce or none beside {beside}"
            raise ConfigError(problem, where="placement.tallies")
    reduction = reduction_of(workload, machine, placement)
    if max(reduction.time_ps, 2 * barrier_ps(machine)) > CLOCK_LIMIT_PS // 2:
        raise beyond_the_clock()
    if reduction.n_bytes >= MOST_BYTES:
        problem = f"value reduce: the PEs would send {reduction.n_bytes} bytes: expected send"
        raise ConfigError(problem, where="placement.tallies")
