"""What a run gives back: integers that add up.

A further column of ``results.csv`` is a name in ``columns`` and a field or property of ``Result``;
what has to be counted for it is declared in ``arrays.records`` and counted where it happens, in
``pe.step.note_peaks`` if it is the most that a PE holds of something.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simmpp.common.displayed import Displayed
from simmpp.common.documented import documented
from simmpp.common.errors import ModelError
from simmpp.engine.arrays.records import SINGLY
from simmpp.engine.residuals import times_of_residuals
from simmpp.engine.rounds import barriers, round_ends
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST
from simmpp.machine.uneven import bound_of

if TYPE_CHECKING:  # who only reads results needs no numba
    from simmpp.engine.memory_use import MemoryUse
    from simmpp.engine.record.counters import Counters
    from simmpp.engine.state import State
    from simmpp.engine.tallies import Reduction
    from simmpp.machine.machine import Machine
    from simmpp.workload.workload import Workload


@documented
@dataclass(frozen=True, eq=False)
class Result(Displayed):
    """Makespan, counters and the accounts of every PE, clipped at the makespan."""

    policy: str
    """Its label or name."""
    engine: str
    """Which event loop ran it; all give the same integers."""
    makespan_ps: int
    """Simulated time until the last ray is finished."""
    messages_by_kind: tuple[int, int, int, int]
    """Messages sent, by the kind of their first part: requests, objects, rays, loads."""
    parts_by_kind: tuple[int, int, int, int]
    """Parts of them; each is a message of its own where nothing is packed."""
    messages_received: int
    """Messages whose receive activity has begun; the others were in flight at the end."""
    bytes_sent: int
    """With headers."""
    rays: int
    """Rays finished."""
    tests: int
    """Ray-object intersections computed."""
    rays_sent: int
    """Rays moved by messages."""
    compute_ps: NDArray[np.int64]
    """(nb,) int64: time of each PE in computing: tests and rays, and what launch_ps says."""
    communication_ps: NDArray[np.int64]
    """(nb,) int64: startups, packing, unpacking, probes."""
    waiting_ps: NDArray[np.int64]
    """(nb,) int64: makespan - compute - communication."""
    service_ps: NDArray[np.int64]
    """(nb,) int64: time of each PE's thread, beside these; 0 where the machine has none."""
    pe_peak_rays: NDArray[np.int64]
    """(nb,) int64: most rays that each PE held."""
    pe_peak_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes that each PE held."""
    pe_peak_object_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes of objects, resident and fetched, that each PE held."""
    events: int
    """Activities and arrivals."""
    user_messages: int = 0
    """Messages of the policy's own that were sent."""
    user_dropped: int = 0
    """Further ones that were not: too many, or to nobody."""
    steal_messages: int = 0
    """Questions for pixels and answers to them."""
    launch_ps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(nb,) int64: of compute_ps, startups of computing, and what lanes left empty add."""
    work_ps: int = 0
    """What all tests and rays cost: T(1), the makespan of one PE that holds everything."""
    bound_ps: int = 0
    """That over the sum of all PEs' speeds (nb where all have 1), rounded up."""
    round_ends_ps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(rounds,) int64: when the last ray of each round was finished; -1 where a run came to no end
    before."""
    residuals_ps: dict[str, int] = field(default_factory=dict)
    """When little was left to be done, of tables that say what is left: see ``residuals.LEFT``."""
    barriers: int = 0
    """Ends of rounds that others waited for."""
    barrier_ps: int = 0
    """Time of them all, from the last ray's end until every PE knew."""
    round_messages: int = 0
    """Messages of barriers, and of reductions that rounds began with."""
    tally_messages: int = 0
    """Messages of deposits, or of the reduction in which the copies of all tallies are added."""
    deposits: int = 0
    """Deposits in them."""
    reduction_ps: int = 0
    """Time of that reduction, when the last ray is finished; in the makespan, and in
    communication_ps of every PE."""
    rules_never_fired: tuple[str, ...] = ()
    """Rules that the policy has but that never sent or asked: "send", "ask"."""
    memory: MemoryUse | None = None
    """What became of the memory of PEs, where it has a capacity."""
    log: NDArray[np.void] | None = None
    """Event log, if asked for (see ``engine.log``)."""
    counters: Counters | None = None
    """With ``Recording.counters``: what happened when, and who sent how much to whom."""
    ray_hops: NDArray[np.int32] | None = None
    """(n,) int32, with ``Recording.hops``: links crossed for each ray, by itself in a message or by
    the requests and objects that it waited for. A view of the run's state, 16 bytes per ray."""
    ray_ends_ps: NDArray[np.int64] | None = None
    """(n,) int64, with ``Recording.ends``: when each ray was finished."""
    tested_rays: NDArray[np.int32] | None = None
    """(tests,) int32, with ``Recording.tests``: the ray of each test in the order performed."""
    tested_objects: NDArray[np.int32] | None = None
    """(tests,) int32, with ``Recording.tests``: the object of each test."""

    @property
    def peak_rays(self) -> int:
        """Rays held (ready and waiting) by the PE that ever held most."""
        return int(self.pe_peak_rays.max())

    @property
    def peak_bytes(self) -> int:
        """Bytes held (resident and fetched objects, rays) by the PE that ever held most."""
        return int(self.pe_peak_bytes.max())

    @property
    def messages(self) -> int:
        """Messages sent, of all kinds."""
        own = self.user_messages + self.steal_messages
        own += self.round_messages + self.tally_messages
        return sum(self.messages_by_kind) + own

    @property
    def parts(self) -> int:
        """Parts of messages, of all kinds."""
        return sum(self.parts_by_kind)

    @property
    def request_messages(self) -> int:
        """Messages of nothing but object requests."""
        return self.messages_by_kind[REQUEST]

    @property
    def object_messages(self) -> int:
        """Messages of objects."""
        return self.messages_by_kind[OBJECT]

    @property
    def ray_messages(self) -> int:
        """Messages with rays."""
        return self.messages_by_kind[RAYS]

    @property
    def load_messages(self) -> int:
        """Messages that carried nothing but the sender's load."""
        return self.messages_by_kind[LOAD]

    @property
    def request_parts(self) -> int:
        """Object requests sent."""
        return self.parts_by_kind[REQUEST]

    @property
    def object_parts(self) -> int:
        """Objects sent."""
        return self.parts_by_kind[OBJECT]

    @property
    def ray_parts(self) -> int:
        """Batches of rays sent."""
        return self.parts_by_kind[RAYS]

    @property
    def objects_fetched(self) -> int:
        """Objects sent as answers to requests."""
        return self.object_parts

    @property
    def peak_object_bytes(self) -> int:
        """Bytes of objects (resident, fetched) held by the PE that ever held most of them."""
        return int(self.pe_peak_object_bytes.max())


def concluded(
    state: State,
    arrivals: int,
    policy: str,
    engine: str,
    log: NDArray[np.void] | None,
    use: MemoryUse | None,
    machine: Machine,
    workload: Workload,
    reduction: Reduction,
    work_ps: int | None = None,
) -> Result:
    """Clip the accounts at the makespan and check that the machine lost nothing.

    A run that could not be brought to its end has no makespan: the time is that of its last event.
    Without ``work_ps``, that of a machine that is not uneven, PEs have computed nothing else.
    """
    makespan_ps = state["last_ray_ps"]
    if state.infeasible:
        makespan_ps = max(makespan_ps, int(state.pes["busy_until_ps"].max()))
    overrun_ps = np.maximum(state.pes["busy_until_ps"] - makespan_ps, 0)
    communication_ps = state.pes["communication_ps"] - overrun_ps
    late_ps = np.maximum(state.pes["served_until_ps"] - makespan_ps, 0)
    compute_ps = state.pes["compute_ps"].copy()
    waiting_ps = makespan_ps - compute_ps - communication_ps
    work_ps = int(compute_ps.sum()) if work_ps is None else work_ps
    (*sent, user_messages, steal_messages, deposit_messages), bytes_sent = state.sent_until(
        makespan_ps
    )
    n_barriers, barrier_ps, round_messages = barriers(state, workload, machine)
    sent_by_kind = (sent[REQUEST], sent[OBJECT], sent[RAYS], sent[LOAD])
    parts_by_kind = _parts(state, sent_by_kind)
    if (waiting_ps < 0).any() or (communication_ps < 0).any():
        raise ModelError(f"the accounts of a PE exceed the makespan of {makespan_ps} ps")
    return Result(
        policy=policy,
        engine=engine,
        makespan_ps=makespan_ps + reduction.time_ps,
        messages_by_kind=sent_by_kind,
        parts_by_kind=parts_by_kind,
        messages_received=state["received"],
        bytes_sent=bytes_sent + round_messages * machine.header_bytes + reduction.n_bytes,
        rays=state["rays_done"],
        tests=state["tests"],
        rays_sent=state["rays_sent"],
        compute_ps=compute_ps,
        communication_ps=communication_ps + reduction.time_ps,
        waiting_ps=waiting_ps,
        service_ps=state.pes["service_ps"] - late_ps,
        pe_peak_rays=state.pes["peak_rays"].copy(),
        pe_peak_bytes=state.pes["peak_bytes"].copy(),
        pe_peak_object_bytes=state.pes["peak_object_bytes"].copy(),
        events=state["activities"] + arrivals,
        user_messages=user_messages,
        user_dropped=state["user_dropped"],
        steal_messages=steal_messages,
        launch_ps=state.pes["launch_ps"].copy(),
        work_ps=work_ps,
        bound_ps=bound_of(work_ps, machine.speed, machine.processors),
        round_ends_ps=(ends_ps := round_ends(state)),
        residuals_ps=times_of_residuals(workload.round_residuals, ends_ps),
        barriers=n_barriers,
        barrier_ps=barrier_ps,
        round_messages=round_messages,
        tally_messages=deposit_messages + reduction.messages,
        deposits=state["deposited"],
        reduction_ps=reduction.time_ps,
        rules_never_fired=_never_fired(state, parts_by_kind),
        memory=use,
        log=log,
        counters=state.counters() if state["record_counters"] else None,
        ray_hops=state.arrays["rays"]["hops"] if state["record_hops"] else None,
        ray_ends_ps=state.arrays["ends_ps"] if state["record_ends"] else None,
        tested_rays=state.arrays["tested_rays"] if state["record_tests"] else None,
        tested_objects=state.arrays["tested_objects"] if state["record_tests"] else None,
    )


def _parts(state: State, sent_by_kind: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Only packed messages have their parts counted; of loads nothing is packed."""
    if state["packing"] == SINGLY:
        return sent_by_kind
    requests, objects, rays, *_ = state.arrays["parts_by_kind"].tolist()
    return requests, objects, rays, sent_by_kind[LOAD]


def _never_fired(state: State, parts_by_kind: tuple[int, int, int, int]) -> tuple[str, ...]:
    fired = {
        "send": not state["sends"] or parts_by_kind[RAYS] > 0,
        "ask": not state["asks"] or parts_by_kind[REQUEST] > 0,
    }
    return tuple(rule for rule, it_did in fired.items() if not it_did)
