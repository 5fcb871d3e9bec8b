"""Synchronous simulation equals the paper's formulas, fed with the run's own n and r, exactly."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import BANDWIDTHS, TIMES_PS, random_placement, random_workload

from simmpp.common.errors import ConfigError
from simmpp.machine.machine import CopyCost, Machine, TestCost
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.torus import default_shape
from simmpp.model.costs import costs_of
from simmpp.model.formulas import makespan
from simmpp.model.lockstep import steps_of
from simmpp.model.measured import step_times_ps
from simmpp.model.synchronous import (
    DATAFLOWS,
    MOST_PROCESSORS,
    Counts,
    Dataflow,
    SynchronousResult,
    synchronous,
)
from simmpp.model.synthetic import LIVES, synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.workload.workload import Workload

DRAWS = 500
TIMES = TIMES_PS["even"] + TIMES_PS["ties"] + (10**6, 123_456_789)
RATES = (*BANDWIDTHS["even"], *BANDWIDTHS["ties"], 7_000_000, 256_000_000, 999_999_937)


def random_machine(rng: np.random.Generator, nb: int) -> Machine:
    """Costs that differ in everything; all tests cost the same, as in the model."""

    def time() -> int:
        return int(rng.choice(TIMES))

    def copies() -> tuple[CopyCost, CopyCost, CopyCost, CopyCost]:
        a, b, c, d = (CopyCost(time(), int(rng.choice(RATES))) for _ in range(4))
        return a, b, c, d

    test_ps = time()
    return Machine(
        "random",
        default_shape(nb),
        send_startup_ps=time(),
        receive_startup_ps=time(),
        probe_ps=time(),
        pack=copies(),
        unpack=copies(),
        header_bytes=int(rng.integers(100)),
        request_bytes=int(rng.integers(100)),
        ray_bytes=int(rng.integers(300)),
        latency_ps=time(),
        hop_latency_ps=time(),
        link_bytes_per_s=int(rng.choice(RATES)),
        injection_bytes_per_s=int(rng.choice(RATES)),
        test=TestCost(test_ps, test_ps, test_ps, test_ps),
        ray_ps=time(),
        quantum=int(rng.integers(1, 100)),
    )


def draw(seed: int) -> tuple[Workload, Machine, Placement]:
    """nb, x, costs and workload: the model's own in half of the draws, a tree of rays otherwise."""
    rng = np.random.default_rng(seed)
    nb = int(rng.integers(1, 33))
    machine = random_machine(rng, nb)
    if seed % 2:
        workload = random_workload(rng)
        size = int(rng.integers(4000))
        workload.object_bytes[:] = size
        return workload, machine, random_placement(rng, workload, nb)
    workload = synthetic(
        int(rng.integers(1, 300)),
        int(rng.integers(1, 12)),
        int(rng.integers(1, 60)),
        lives=LIVES[int(rng.integers(2))],
        object_bytes=int(rng.integers(4000)),
        seed=seed,
    )
    memory = Memory(Fraction(int(rng.integers(101)), 100))
    owners = ("bisection", "random", "round_robin")[int(rng.integers(3))]
    return workload, machine, place(workload, nb, memory, PlacementRules(owners), seed)


def transfer(cost: CopyCost, n_bytes: int) -> int:
    """fixed + bytes / bandwidth in exact fractions, halves up."""
    if cost.bytes_per_s == 0:
        return cost.fixed_ps
    time = Fraction(n_bytes * 10**12, cost.bytes_per_s)
    return cost.fixed_ps + int(time + Fraction(1, 2))


def transcribed(
    counts: Counts, machine: Machine, dataflow: Dataflow, object_bytes: int
) -> list[list[int]]:
    """TC(i, k) and TO(i, k) from n and r, written out in Python's integers."""
    nb, (n_steps, _) = machine.processors, counts.tests.shape
    r = np.zeros((n_steps, nb, nb), int)
    r[counts.steps, counts.holders, counts.owners] = counts.rays
    pack, unpack = machine.pack, machine.unpack
    startup = machine.send_startup_ps + machine.receive_startup_ps
    ask = startup + transfer(pack[REQUEST], machine.request_bytes)
    ask += transfer(unpack[OBJECT], object_bytes)
    serve = startup + transfer(pack[OBJECT], object_bytes)
    serve += transfer(unpack[REQUEST], machine.request_bytes)
    times = []
    for k in range(n_steps):
        row = []
        for i in range(nb):
            time = int(counts.tests[k, i]) * machine.test.sphere_ps
            time += int(counts.ended[k, i]) * machine.ray_ps
            for j in range(nb):
                sent, got = int(r[k, i, j]), int(r[k, j, i])
                if j != i and dataflow == "object":
                    time += ask * sent + serve * got
                elif j != i:
                    time += startup + transfer(pack[RAYS], sent * machine.ray_bytes)
                    time += transfer(unpack[RAYS], got * machine.ray_bytes)
            row.append(time)
        times.append(row)
    return times


def object_bytes_of(workload: Workload) -> int:
    return int(workload.object_bytes[0]) if workload.n_objects else 0


def run(seed: int, dataflow: Dataflow) -> tuple[SynchronousResult, list[list[int]]]:
    workload, machine, placement = draw(seed)
    result = synchronous(workload, machine, placement, dataflow)
    size = object_bytes_of(workload)
    return result, transcribed(result.counts, machine, dataflow, size)


@pytest.mark.parametrize("dataflow", DATAFLOWS)
def test_500_draws_are_equal_to_the_picosecond(dataflow: Dataflow) -> None:
    busy = 0
    for seed in range(DRAWS):
        result, expected = run(seed, dataflow)
        assert result.times_ps.tolist() == expected, f"draw {seed}"
        assert result.makespan_ps == sum(map(max, expected)), f"draw {seed}"
        busy += len(result.counts.rays) > 0
    assert busy > DRAWS / 2  # most draws have rays that lack objects


@pytest.mark.parametrize("dataflow", DATAFLOWS)
def test_the_package_formulas_are_these_formulas(dataflow: Dataflow) -> None:
    for seed in range(80):
        same_formulas(dataflow, seed)


def same_formulas(dataflow: Dataflow, seed: int) -> None:
    workload, machine, placement = draw(seed)
    counts = synchronous(workload, machine, placement, dataflow).counts
    costs = costs_of(machine, workload)
    times = step_times_ps(counts, dataflow, machine, costs)
    expected = np.array(transcribed(counts, machine, dataflow, object_bytes_of(workload)))
    assert times.dtype == np.int64
    assert times.tolist() == expected.reshape(times.shape).tolist()
    assert int(makespan(times)) == sum(map(max, expected.tolist()))


@pytest.mark.parametrize("dataflow", DATAFLOWS)
def test_every_ray_makes_its_tests_once(dataflow: Dataflow) -> None:
    for seed in range(60):
        workload, machine, placement = draw(seed)
        counts = synchronous(workload, machine, placement, dataflow).counts
        steps = steps_of(workload)
        assert counts.tests.sum(axis=1).tolist() == steps.tests.tolist()
        assert counts.ended.sum(axis=1).tolist() == steps.ended.tolist()
        assert counts.tests.sum() == workload.n_tests
        assert counts.ended.sum() == workload.n_rays


def test_a_run_that_would_not_fit_the_clock_is_refused() -> None:
    workload, machine, placement = draw(2)
    slow = replace(machine, send_startup_ps=1 << 60)
    with pytest.raises(ConfigError, match="clock"):
        synchronous(workload, slow, placement, "object")


def test_more_processors_than_dense_counts_hold_are_refused() -> None:
    workload, machine, placement = draw(2)
    wide = replace(machine, shape=(MOST_PROCESSORS + 1, 1, 1))
    with pytest.raises(ConfigError, match="processors: 4097, expected at most 4096"):
        synchronous(workload, wide, placement, "object")


def test_rays_move_in_ray_dataflow_as_equation_2_says() -> None:
    """n(i, k) is the sum of r(j, i, k) over all j, with the rays that stay."""
    workload, machine, placement = draw(2)
    counts = synchronous(workload, machine, placement, "ray").counts
    before = np.bincount(placement.pixel_pes, minlength=machine.processors)
    for k in range(len(counts.tests)):
        moved = before - counts.missing_by_holder()[k] + counts.missing_by_owner()[k]
        assert counts.tests[k].tolist() == moved.tolist()
        before = counts.tests[k] - counts.ended[k]


def test_waiting_for_messages_only_adds_time() -> None:
    longer = 0
    for seed in range(0, 100, 2):
        workload, machine, placement = draw(seed)
        for dataflow in DATAFLOWS:
            plain = synchronous(workload, machine, placement, dataflow)
            waits = synchronous(workload, machine, placement, dataflow, waits=True)
            assert (waits.times_ps >= plain.times_ps).all()
            assert waits.counts.tests.tolist() == plain.counts.tests.tolist()
            longer += waits.makespan_ps > plain.makespan_ps
    assert longer > 0
