"""The numbers behind a run's pictures are those of its result, its log and the oracle's torus."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, cast

import matplotlib
import numpy as np
import pytest
from builders import Case, cases, placement_of, random_case, with_policy, workload_of
from hypothesis import example, given, settings
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from oracles.costs import hops_from, neighbours
from oracles.network import WAYS, distance

from simmpp.common.compiled import njit
from simmpp.common.modules import PICTURES
from simmpp.engine.arrays.records import ARRIVAL, BINS, COMPUTE, NONE, RECEIVE, SEND, SIZES
from simmpp.engine.record.recording import Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.machine.machine import FAT_TREE, TORUS, CopyCost, Machine, TestCost
from simmpp.machine.messages import MESSAGE_KINDS, RAYS, USER
from simmpp.machine.torus import DIRECTIONS, ROWS_PER_PE, link_towards
from simmpp.plot.matplotlib_panels import SETTINGS
from simmpp.policy.parameters import PolicyParameters
from simmpp.report.run_figures.data import Motion, marks_of, motion_of
from simmpp.report.run_figures.drawing import _progress
from simmpp.report.run_figures.recorder import _draw
from simmpp.report.run_figures.torus import draw_torus
from simmpp.report.run_figures.tree import draw_tree, links_of
from simmpp.run.point import Point, PolicyRun
from simmpp.sweeps.executors import processes

many = settings(max_examples=40, deadline=None, derandomize=True)


def seen(case: Case, log: bool = False) -> tuple[Result, Motion]:
    """A run and the data of its pictures; and its event log, from another run."""
    point = Point(cast(Any, None), case.workload, case.machine, case.placement, seed=0)
    options: dict[str, Any] = {"ready_order": case.ready_order}
    noted = Recording(counters=True, hops=True)
    arguments = (case.workload, case.machine, case.placement, case.policy)
    result = simulate(*arguments, **options, record=noted)
    motion = motion_of(point, PolicyRun(case.policy, result, named=True, wall_s=0.0))
    if not log:
        return result, motion
    return simulate(*arguments, **options, record=replace(noted, log=True)), motion


@given(case=cases())
@many
def test_accounts_of_the_bins_are_those_of_the_result(case: Case) -> None:
    result, motion = seen(case)
    assert motion.compute_ps.sum(axis=1).tolist() == result.compute_ps.tolist()
    assert motion.communication_ps.sum(axis=1).tolist() == result.communication_ps.tolist()
    assert motion.waiting_ps.sum(axis=1).tolist() == result.waiting_ps.tolist()
    assert motion.waiting_ps.min() >= 0
    assert motion.compute_ps.shape[1] <= BINS
    assert motion.times_ps[-1] == result.makespan_ps
    assert 0 <= motion.utilisation.min() <= motion.utilisation.max() <= 1


@given(case=cases())
@many
def test_traffic_is_all_messages_and_bytes(case: Case) -> None:
    result, motion = seen(case)
    assert int(motion.messages.sum()) == result.messages
    assert int(motion.bytes.sum()) == result.bytes_sent
    of_kinds = motion.sizes.sum(axis=1).tolist()
    assert tuple(of_kinds[:USER]) == result.messages_by_kind
    assert not any(of_kinds[USER:])
    assert int(motion.batches[0].sum()) == result.ray_messages
    assert int(motion.batches[1].sum()) == result.rays_sent


@given(case=cases())
@many
def test_bytes_over_links_are_bytes_times_hops(case: Case) -> None:
    _, motion = seen(case)
    pairs = list(product(range(case.machine.processors), repeat=2))
    far = np.reshape([distance(case.machine, i, j) for i, j in pairs], motion.bytes.shape)
    way = WAYS[case.machine.topology]
    links = [len(way(case.machine, i, j, 0)) - 2 if i != j else 0 for i, j in pairs]  # and ports
    assert int(motion.link_bytes.sum()) == int((motion.bytes.flat * np.array(links)).sum())
    expected = [int(motion.messages[far == h].sum()) for h in range(len(motion.hops))]
    assert motion.hops.tolist() == expected


@given(case=cases())
@many
def test_rays_are_finished_when_the_log_says(case: Case) -> None:
    result, motion = seen(case, log=True)
    assert result.log is not None
    computed = result.log[result.log["event"] == COMPUTE]
    edges = motion.times_ps
    done = [int(computed["rays"][computed["end_ps"] <= edge].sum()) for edge in edges[1:]]
    assert np.cumsum(motion.finished).tolist() == done
    assert done[-1] == result.rays
    assert motion.marks_ps[100] <= result.makespan_ps
    if result.rays:
        early = computed["end_ps"] <= motion.marks_ps[95]
        assert int(computed["rays"][early].sum()) * 100 >= 95 * result.rays


@given(case=cases())
@example(case=with_policy(random_case(21), name="concurrent", packing="all"))
@many
def test_mean_load_is_that_of_the_log(case: Case) -> None:
    # in the example requests depart before rays that have left the load with the decision
    result, motion = seen(case, log=True)
    assert result.log is not None
    started = np.bincount(case.placement.pixel_pes, minlength=case.machine.processors)
    for pe, mean in enumerate(motion.load):
        rows = result.log[(result.log["pe"] == pe) & (result.log["event"] != 0)]
        times = [0, *rows["end_ps"].tolist(), result.makespan_ps]
        loads = [int(started[pe]), *rows["load"].tolist()]
        held = sum(n * (b - a) for n, a, b in zip(loads, times[:-1], times[1:], strict=True))
        assert abs(mean * result.makespan_ps - held) <= 1e-9 * held


@given(case=cases())
@many
def test_memory_and_pixels_add_up(case: Case) -> None:
    result, motion = seen(case)
    assert int(motion.pixel_cost_ps.sum()) == result.work_ps
    assert int(motion.peak_bytes.max()) == result.peak_bytes
    assert int(motion.queue_bytes.max()) == result.peak_rays * case.machine.ray_bytes
    most = motion.resident_bytes + motion.transient_bytes + motion.queue_bytes
    assert (motion.peak_bytes <= most).all()
    assert motion.transient_bytes.min() >= 0
    assert motion.pixel_owner.ravel().tolist() == case.placement.pixel_pes.tolist()


@given(case=cases())
@settings(max_examples=15, deadline=None, derandomize=True)
def test_links_of_trees_carry_what_their_pes_exchange_with_others(case: Case) -> None:
    _, motion = seen(case)
    nb = case.machine.processors
    if case.machine.topology == TORUS:
        return
    links = links_of(motion)
    for height in range(int(max(link.above[1] for link in links))):
        here = [link for link in links if link.below[1] == height]
        far = np.reshape(
            [distance(case.machine, i, j) for i in range(nb) for j in range(nb)], (nb, nb)
        )
        beyond = far > (2 * height if case.machine.topology == FAT_TREE else height)
        crossed = int(motion.bytes[beyond].sum())
        assert sum(link.up_bytes for link in here) == crossed
        assert sum(link.down_bytes for link in here) == crossed
    figure = Figure(layout="constrained")
    draw_tree(figure, motion)
    FigureCanvasAgg(figure).draw()


@given(case=cases())
@many
def test_hops_of_rays_are_those_of_the_messages_that_carried_them(case: Case) -> None:
    # unmerged, an object is fetched for one ray; else for as many as its receipt makes ready
    case = with_policy(case, merge_requests=False)
    result, motion = seen(case, log=True)
    assert result.log is not None
    links = 0
    for row in result.log[(result.log["event"] == RECEIVE)]:
        far = distance(case.machine, int(row["other"]), int(row["pe"]))
        links += far * int(row["rays"]) + 2 * far * int(row["objects"])
    assert int(motion.pixel_hops.sum()) == links
    assert (result.log["number"][result.log["event"] == SEND] != NONE).sum() == result.messages


@given(case=cases(), engine=st.sampled_from(list(ENGINES)))
@many
def test_counters_are_those_of_the_event_log(case: Case, engine: str) -> None:
    counted_run(case, engine)


@pytest.mark.parametrize("engine", list(ENGINES))
@pytest.mark.parametrize("seed", [32, 170])
def test_loads_that_never_depart_are_not_counted(seed: int, engine: str) -> None:
    case = with_policy(random_case(seed), refresh_ps=0, sample_ps=None, load_info="piggyback")
    log = counted_run(case, engine)
    assert ((log["event"] == SEND) & (log["number"] == NONE)).any()


def counted_run(case: Case, engine: str) -> NDArray[np.void]:
    """The event log of a run, which says the same as its counters."""
    options: dict[str, Any] = {"ready_order": case.ready_order, "engine": engine}
    arguments = (case.workload, case.machine, case.placement, case.policy)
    result = simulate(*arguments, **options, record=Recording(log=True, counters=True))
    alone = simulate(*arguments, **options, record=Recording(counters=True)).counters
    counted = result.counters
    assert counted is not None and alone is not None and result.log is not None
    for name, expected in counters_of(case, result.log, result.makespan_ps).items():
        assert np.array_equal(getattr(counted, name), expected), name
        assert np.array_equal(getattr(alone, name), expected), name
    return result.log


def counters_of(case: Case, log: NDArray[np.void], makespan_ps: int) -> dict[str, Any]:
    """The counters by hand, picosecond ranges cut at the edges of bins."""
    nb, bin_ps = case.machine.processors, 1
    while bin_ps * BINS < makespan_ps:
        bin_ps *= 2
    found: dict[str, Any] = {
        "compute_ps": np.zeros((nb, BINS), np.int64),
        "communication_ps": np.zeros((nb, BINS), np.int64),
        "finished": np.zeros(BINS, np.int64),
        "batches": np.zeros((3, BINS), np.int64),
        "messages": np.zeros((nb, nb), np.int64),
        "bytes": np.zeros((nb, nb), np.int64),
        "sizes": np.zeros((len(MESSAGE_KINDS), SIZES), np.int64),
    }
    edges = np.arange(BINS + 1) * bin_ps
    for row in log[log["event"] != ARRIVAL]:
        pe, begin_ps, end_ps = int(row["pe"]), int(row["time_ps"]), int(row["end_ps"])
        ending = max(end_ps - 1, 0) // bin_ps
        tests_ps = begin_ps + case.machine.probe_ps if row["event"] == COMPUTE else end_ps
        found["communication_ps"][pe] += np.diff(np.clip(edges, begin_ps, tests_ps))
        found["compute_ps"][pe] += np.diff(np.clip(edges, tests_ps, end_ps))
        if row["event"] == COMPUTE:
            found["finished"][ending] += row["rays"]
        if row["event"] == SEND and row["number"] != NONE:
            n_bytes = int(row["payload_bytes"]) + case.machine.header_bytes
            found["messages"][pe, row["other"]] += 1
            found["bytes"][pe, row["other"]] += n_bytes
            found["sizes"][row["kind"], n_bytes.bit_length()] += 1
            if row["kind"] == RAYS:
                found["batches"][:2, ending] += 1, row["rays"]
                found["batches"][2, ending] = max(found["batches"][2, ending], row["rays"])
    return found | {"bin_ps": bin_ps}


def test_one_ray_that_fetches_one_object() -> None:
    # PE 0 and 2 of a ring of 4: 2 hops for the request, 2 for the object
    workload = workload_of(1, [[0, 1]], object_bytes=(40, 50))
    machine = Machine(**MACHINE)
    placement = placement_of((0, 2), [0], 4)
    case = Case(workload, machine, placement, PolicyParameters("object"))
    result, motion = seen(case)
    assert motion.pixel_hops.tolist() == [[4]]
    assert motion.messages[0, 2] == motion.messages[2, 0] == 1
    assert (motion.bytes[0, 2], motion.bytes[2, 0]) == (8 + 4, 50 + 4)
    # ties go towards +: 0 -> 1 -> 2 and 2 -> 3 -> 0
    assert motion.link_bytes[:, 0].tolist() == [12, 12, 54, 54]
    assert motion.link_bytes[:, 1:].sum() == 0
    assert motion.hops.tolist() == [0, 0, 2]
    sizes = {k: np.flatnonzero(motion.sizes[i]).tolist() for i, k in enumerate(MESSAGE_KINDS)}
    assert {k: of for k, of in sizes.items() if of} == {"request": [4], "object": [6]}
    assert motion.transient_bytes.tolist() == [50, 0, 0, 0]
    assert motion.resident_bytes.tolist() == [40, 0, 50, 0]
    assert motion.pixel_cost_ps.tolist() == [[2 * 1000 + 500]]
    assert motion.marks_ps[100] == result.makespan_ps


def test_one_pe_has_room_for_its_scales_and_no_ticks_where_nothing_was_sent() -> None:
    machine = Machine(**{**MACHINE, "shape": (1, 1, 1)})
    placement = placement_of((0, 0), [0], 1)
    workload = workload_of(1, [[0, 1]], object_bytes=(40, 50))
    motion = seen(Case(workload, machine, placement, PolicyParameters("ray")))[1]
    with matplotlib.rc_context(SETTINGS):
        torus, progress = Figure(layout="constrained"), Figure(layout="constrained")
        draw_torus(torus, motion)
        _progress(progress, motion)
        FigureCanvasAgg(torus).draw()
    _stands_within(torus)
    assert len(progress.axes[1].get_yticks()) == 0


def test_scales_of_a_torus_of_many_layers_stand_within_its_edges() -> None:
    """Laid out once: divisions that depend on the height of a scale would need a second time."""
    machine = Machine(**{**MACHINE, "shape": (4, 4, 4)})
    placement = placement_of((0, 63), [0], 64)
    workload = workload_of(1, [[0, 1]], object_bytes=(40, 195_000))
    motion = seen(Case(workload, machine, placement, PolicyParameters("object")))[1]
    with matplotlib.rc_context(SETTINGS):
        torus = Figure(layout="constrained")
        draw_torus(torus, motion)
        FigureCanvasAgg(torus).draw()
    _stands_within(torus)


def _stands_within(figure: Figure) -> None:
    for axes in figure.axes:
        box = axes.get_tightbbox()
        assert min(box.x0, box.y0) >= 0
        assert box.x1 <= figure.bbox.width
        assert box.y1 <= figure.bbox.height


MACHINE: dict[str, Any] = {
    "name": "by hand", "shape": (4, 1, 1), "send_startup_ps": 10, "receive_startup_ps": 20,
    "probe_ps": 1, "header_bytes": 4, "request_bytes": 8, "ray_bytes": 10, "latency_ps": 100,
    "hop_latency_ps": 30, "link_bytes_per_s": 10**12, "injection_bytes_per_s": 0,
    "ray_ps": 500, "quantum": 4, "test": TestCost(1000, 154, 1250, 7),
    "pack": (CopyCost(2), CopyCost(3), CopyCost(4), CopyCost(5)),
    "unpack": (CopyCost(6), CopyCost(7), CopyCost(8), CopyCost(9)),
}  # fmt: skip


def test_pictures_drawn_beside_are_those_drawn_here(tmp_path: Path) -> None:
    workload = workload_of(2, [[0, 1], [0]], object_bytes=(40, 50))
    placement = placement_of((0, 2), [0, 0], 4)
    case = Case(workload, Machine(**MACHINE), placement, PolicyParameters("ray"))
    motion = seen(case)[1]
    assert set(motion.pictures) == {"activity", "progress", "torus", "traffic", "memory", "pixels"}
    for workers in (1, 2):
        folder = tmp_path / str(workers)
        folder.mkdir()
        with processes(workers, PICTURES) as executor:
            drawings = [executor.submit(_draw, name, motion, folder) for name in motion.pictures]
            paths = [path for drawing in drawings for path in drawing.result()]
        assert sorted(paths) == sorted(folder.iterdir())
    here, beside = ({p.name: p.read_bytes() for p in (tmp_path / n).iterdir()} for n in "12")
    assert here == beside
    assert len(here) == 12


def test_marks_are_the_ends_of_the_bins_where_shares_are_reached() -> None:
    finished, edges = np.array([0, 94, 1, 3, 1, 1]), np.array([0, 10, 20, 30, 40, 50, 55])
    assert marks_of(finished, edges) == {95: 30, 99: 50, 100: 55}


@njit
def link_from(shape: tuple[int, int, int], here: int, destination: int) -> tuple[int, int]:
    """What only compiled code may call, for the test."""
    return link_towards(shape, here, destination)


def test_routes_are_shortest_and_go_along_x_then_y_then_z() -> None:
    steps = [(1, 0), (-1, 0), (1, 1), (-1, 1), (1, 2), (-1, 2)]
    for shape in ((4, 3, 2), (5, 2, 2), (1, 1, 1), (2, 1, 1), (6, 1, 3)):
        nb = shape[0] * shape[1] * shape[2]
        strides = (1, shape[0], shape[0] * shape[1])
        for source in range(nb):
            far = hops_from(shape, source)
            for destination in range(nb):
                here, axes = source, []
                while here != destination:
                    link, following = link_from(shape, here, destination)
                    pe, direction = divmod(link, ROWS_PER_PE)
                    assert pe == here
                    way, axis = steps[direction]
                    assert DIRECTIONS[direction] == f"{'+' if way > 0 else '-'}{'xyz'[axis]}"
                    size, stride = shape[axis], strides[axis]
                    at = here // stride % size
                    there = here + ((at + way) % size - at) * stride
                    assert following == there in neighbours(shape, here)
                    assert way > 0 or size > 2  # a ring of 2 uses its + link only
                    here, axes = there, [*axes, axis]
                assert len(axes) == far[destination]
                assert axes == sorted(axes)
