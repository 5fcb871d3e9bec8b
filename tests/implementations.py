"""One way to run a case on the oracle or on an engine, and to see the same things of each."""

from __future__ import annotations

from importlib.util import find_spec

from builders import Case
from oracles.machine import Outcome
from oracles.machine import simulate as simulate_slowly

ENGINES = ("simpy", "compiled") if find_spec("simmpp.engine.simulate") else ()
IMPLEMENTATIONS = ("oracle", *ENGINES)


def run(implementation: str, case: Case) -> Outcome:
    """What a run of the case gives, with its log and its tests."""
    if implementation == "oracle":
        return simulate_slowly(
            case.workload, case.machine, case.placement, case.policy, case.ready_order
        )
    raise NotImplementedError(implementation)
