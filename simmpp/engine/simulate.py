"""One run: a workload, a machine, a placement and a policy give a result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from simmpp.common.errors import ModelError
from simmpp.common.validate import require_kind, require_word
from simmpp.engine.bounds import memory_use
from simmpp.engine.capacity import require_room
from simmpp.engine.check import check_fit
from simmpp.engine.compiled_engine import CompiledRun
from simmpp.engine.conclusion import concluded
from simmpp.engine.filling import filled
from simmpp.engine.hook_errors import told_of_hooks
from simmpp.engine.initial import new_state
from simmpp.engine.record.log import Collector
from simmpp.engine.record.recording import NOTHING, Recording
from simmpp.engine.result import Result
from simmpp.engine.simpy_engine import SimpyRun
from simmpp.engine.state import starved
from simmpp.engine.tables.refused import require_known
from simmpp.engine.tables.tallies import reduction_of
from simmpp.machine.limits import beyond_the_clock, check_counters, total_compute_ps
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.hooks import address_of
from simmpp.policy.parameters import PolicyParameters, policy_of
from simmpp.policy.plain import PlainHooks
from simmpp.policy.policy import Policy
from simmpp.workload.workload import Workload

ENGINES: dict[str, type[SimpyRun] | type[CompiledRun]] = {
    "simpy": SimpyRun,
    "compiled": CompiledRun,
}
DEFAULT_ENGINE = "compiled"
READY_ORDERS = ("depth-first", "breadth-first")


def simulate(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters | Policy | str,
    *,
    engine: str = DEFAULT_ENGINE,
    ready_order: str = "depth-first",
    seed: int = 0,
    record: Recording = NOTHING,
    plain_hooks: PlainHooks | None = None,
    progress: Callable[[int], None] | None = None,
) -> Result:
    """Replay a workload on a simulated machine.

    A policy's name stands for it with its defaults, and so does a policy of one's own. ``seed`` is
    that of the random numbers that a policy may be given. ``record`` says what is noted besides the
    totals. With ``plain_hooks`` the policy's hooks are called as plain Python, slowly. ``progress``
    is called now and then with the number of rays left.

    Raises ConfigError or WorkloadError on arguments that do not fit together, ConfigError for an
    exception in a hook of a policy, with file and line, ModelError if rays are left and nothing is
    scheduled (a bug, or a policy that starves).
    """
    policy = policy_of(policy)
    _check(workload, machine, placement, engine, ready_order)
    require_known(workload, machine, placement, policy)
    require_kind("record", record, Recording)
    collector = Collector()
    recording = replace(record, log=collector) if record.log is True else record
    needs = require_room(workload, machine, placement, policy)
    placement, needs = filled(workload, placement, needs)
    state = new_state(
        workload,
        machine,
        placement,
        policy,
        needs=needs,
        ready_order=ready_order,
        seed=seed,
        recording=recording,
        address_of=plain_hooks.address_of if plain_hooks else address_of,
    )
    run = ENGINES[engine](state, progress)
    try:
        with told_of_hooks(policy, state):
            run.run()
    except RuntimeError as error:
        if error.args != ("no progress",):
            raise
        raise ModelError(f"no test was made for too many activities: {starved(state)}") from None
    except OverflowError:
        raise beyond_the_clock() from None
    state.close_log()
    rows = collector.rows() if record.log is True else None
    use = memory_use(state, placement.capacity, needs)
    reduction = reduction_of(workload, machine, placement)
    work_ps = total_compute_ps(workload, machine) if machine.is_uneven else None
    return concluded(
        state, run.arrivals, policy.title, engine, rows, use, machine, workload, reduction, work_ps
    )


def _check(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    engine: str,
    ready_order: str,
) -> None:
    require_kind("workload", workload, Workload)
    require_kind("machine", machine, Machine)
    require_kind("placement", placement, Placement)
    require_word("engine", engine, tuple(ENGINES))
    require_word("ready_order", ready_order, READY_ORDERS)
    check_fit(workload, machine, placement)
    check_counters(workload, machine)
