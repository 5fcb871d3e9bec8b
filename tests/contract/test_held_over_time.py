"""What pictures say a PE holds over time, where memory ends, is what it held, to the picosecond."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from builders import Case, random_case, with_capacity
from by_hand import MACHINE, RAY, case_of

from simmpp.engine.arrays.records import BINS
from simmpp.engine.capacity import capacity_bytes, needs_of
from simmpp.engine.record.recording import Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.machine import CopyCost, TestCost
from simmpp.placement.rooms import LEAST, Capacity, Room
from simmpp.report.run_figures.data import motion_of
from simmpp.report.run_figures.fullest import _lasting
from simmpp.run.point import Point, PolicyRun

SLOWER = 4096
PARTS = ("fetched", "rays", "unread")


def recorded(case: Case, engine: str = "compiled") -> Result:
    return simulate(
        *(case.workload, case.machine, case.placement, case.policy),
        engine=engine,
        ready_order=case.ready_order,
        record=Recording(counters=True, hops=True),
    )


def two_rays(**machine: Any) -> Case:
    """Two rays of PE 0 for PE 1's object: one goes, and no credit is left for the other."""
    case = case_of(RAY, [(0, [1]), (0, [1])], **machine)
    bounds = Capacity(LEAST, buffers=Room(0), fetch=Room(0))
    return replace(case, placement=replace(case.placement, capacity=bounds))


@pytest.mark.parametrize("engine", ENGINES)
def test_two_rays_by_hand(engine: str) -> None:
    """As in ``verify/test_memory_by_hand``: ray 0 leaves at 1 and is there at 169; ray 1 starts at
    25, waits, and is tested when its object has come by the escape."""
    result = recorded(two_rays(), engine)
    assert result.counters is not None and result.counters.bin_ps == 4
    held = _lasting(result.counters.held)
    first, second = held["rays"][0], held["rays"][1]
    assert np.flatnonzero(np.diff(first)).tolist()[:1] == [24 // 4 - 1]
    assert first[: 24 // 4].max() == 0 and first[24 // 4] == 10
    assert np.flatnonzero(second).tolist()[0] == 168 // 4
    assert held["fetched"].max() == 0  # the escape's room is apart
    assert held["rays"][:, -1].tolist() == [0, 0]


def test_joined_bins_say_what_their_last_ones_said() -> None:
    """The machine a thousand times slower outgrows its bins, which are joined by pairs."""
    costs = {
        name: getattr(MACHINE, name) * SLOWER
        for name in ("send_startup_ps", "receive_startup_ps", "probe_ps", "latency_ps", "ray_ps")
    }
    slow = 10**12 // SLOWER
    copies = {
        name: tuple(
            CopyCost(c.fixed_ps * SLOWER, slow if n in (1, 2) else c.bytes_per_s)
            for n, c in enumerate(getattr(MACHINE, name))
        )
        for name in ("pack", "unpack")
    }
    machine = costs | copies | {"hop_latency_ps": 30 * SLOWER, "link_bytes_per_s": slow}
    machine["test"] = TestCost(1000 * SLOWER, 0, 0, 0)
    fast, late = recorded(two_rays()), recorded(two_rays(**machine))
    assert late.makespan_ps == SLOWER * fast.makespan_ps
    assert fast.counters is not None and late.counters is not None
    ours, theirs = _lasting(fast.counters.held), _lasting(late.counters.held)
    ratio = late.counters.bin_ps / fast.counters.bin_ps / SLOWER
    assert ratio in (0.5, 1, 2)
    n = int(fast.makespan_ps // fast.counters.bin_ps)
    for part in PARTS:
        for i in range(1, n):
            at = int((i + 1) / ratio) - 1
            assert ours[part][:, i].tolist() == theirs[part][:, at].tolist(), (part, i)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_held_fits_and_both_engines_say_so(seed: int) -> None:
    case = with_capacity(random_case(seed), seed, flow=("credits", "none")[seed % 3 == 0])
    runs = [recorded(case, engine) for engine in ENGINES]
    held = [_lasting(cast(Any, run.counters).held) for run in runs]
    assert held[0].shape == (case.machine.processors, BINS)
    for part in PARTS:
        assert held[0][part].tolist() == held[1][part].tolist(), part
    needs = needs_of(case.workload, case.machine, case.placement, case.policy)
    used = needs.permanent + np.sum([held[0][part] for part in PARTS], axis=0).max(axis=1)
    bounds, use = case.placement.capacity, runs[0].memory
    assert bounds is not None and use is not None
    if bounds.has_credits:
        assert used.max() <= capacity_bytes(bounds, needs)
    peak = use.peak_resident + use.peak_fetched + use.peak_ray_queue + use.peak_receive
    assert (used - needs.permanent + needs.resident).max() <= peak
    point = Point(cast(Any, None), case.workload, case.machine, case.placement, seed=0)
    motion = motion_of(point, PolicyRun(case.policy, runs[0], named=True, wall_s=0.0))
    assert motion.fullest is not None and "fullest" in motion.pictures
    assert motion.fullest.pe == used.argmax()
