"""The data of a run's pictures: pure functions of its counters, its accounts and its workload."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.engine.record.counters import Ints
from simmpp.engine.residency import resident_bytes
from simmpp.engine.result import Result
from simmpp.machine.fat_tree import Tree
from simmpp.machine.levels import Blocks
from simmpp.machine.topology import (
    Network,
    Topology,
    enter,
    hops,
    network_of,
    next_link,
    topology_of,
)
from simmpp.machine.torus import Torus
from simmpp.report.run_figures.fullest import Fullest, fullest_of
from simmpp.run.point import Point, PolicyRun

OF_NETWORKS: dict[type, tuple[str, ...]] = {Torus: ("torus",), Blocks: ("links",), Tree: ("links",)}
"""Names of the pictures of each topology's links."""
MARKS = (95, 99, 100)
"""Per cent of the rays."""


@dataclass(frozen=True, eq=False)
class Motion:
    """All that the pictures of one run show; nb PEs, B bins of time, integers where not said."""

    title: str
    topology: Topology
    makespan_ps: int
    bin_ps: int
    """Width of a bin of time; the last one ends with the run."""
    compute_ps: Ints
    """(nb, B)."""
    communication_ps: Ints
    """(nb, B)."""
    waiting_ps: Ints
    """(nb, B): with the two above the whole of each bin."""
    finished: Ints
    """(B,): rays finished."""
    marks_ps: dict[int, int]
    """When 95, 99 and 100 % of the rays were finished, at the end of that bin."""
    batches: Ints
    """(3, B): messages of rays, rays in them, rays in the largest."""
    messages: Ints
    """(nb, nb): from row to column."""
    bytes: Ints
    """(nb, nb): with headers."""
    sizes: Ints
    """(kinds, k): messages of each kind whose bytes have k binary digits."""
    hops: Ints
    """(h,): messages that crossed 0, 1, ... links."""
    link_bytes: Ints
    """Bytes over each link, as the topology arranges them."""
    load: NDArray[np.float64]
    """(nb,) float64: mean number of rays held."""
    resident_bytes: Ints
    """(nb,)."""
    transient_bytes: Ints
    """(nb,): most bytes of fetched objects at once."""
    queue_bytes: Ints
    """(nb,): of the most rays held at once."""
    peak_bytes: Ints
    """(nb,): most bytes held at once, at most the sum of the three above."""
    pixel_cost_ps: Ints
    """(rows, columns): tests and rays of each pixel's tree."""
    pixel_hops: Ints
    """(rows, columns): links crossed for them."""
    pixel_owner: Ints
    """(rows, columns): the PE that each pixel starts on."""
    fullest: Fullest | None = None
    """Where memory has a capacity."""
    picture: NDArray[np.uint8] | None = None
    """(rows, columns, 3) uint8: what was rendered, if there is a scene."""

    @property
    def pictures(self) -> list[str]:
        """Names of the pictures that there are of it."""
        networks = OF_NETWORKS.get(type(self.topology), ())
        # Roots that are no pixels, such as particles, are all in one column.
        pixels = ["pixels"] if self.pixel_owner.shape[1] > 1 else []
        fullest = ["fullest"] if self.fullest else []
        return ["activity", "progress", *networks, "traffic", "memory", *fullest, *pixels]

    @property
    def times_ps(self) -> Ints:
        """(B + 1,) int64: edges of the bins."""
        edges = np.arange(len(self.finished) + 1, dtype=np.int64) * self.bin_ps
        return np.minimum(edges, self.makespan_ps)

    @property
    def utilisation(self) -> NDArray[np.float64]:
        """(B,) float64: share of each bin that PEs compute or communicate."""
        busy_ps = (self.compute_ps + self.communication_ps).sum(axis=0)
        whole_ps = np.diff(self.times_ps) * len(self.load)
        return np.asarray(busy_ps / np.maximum(whole_ps, 1), np.float64)

    @property
    def completion(self) -> NDArray[np.float64]:
        """(B,) float64: share of the rays that is finished at the end of each bin."""
        done = np.cumsum(self.finished)
        return np.asarray(done / max(int(done[-1]), 1), np.float64)


def motion_of(point: Point, run: PolicyRun, picture: NDArray[np.uint8] | None = None) -> Motion:
    """The data of all pictures of a run that recorded its counters."""
    result, machine, workload = run.result, point.machine, point.workload
    counters = result.counters
    if counters is None:
        raise ValueError("pictures of a run: expected one that recorded its counters")
    topology, bin_ps = topology_of(machine), counters.bin_ps
    n_bins = max(1, -(-result.makespan_ps // bin_ps))
    compute_ps = counters.compute_ps[:, :n_bins]
    communication_ps = counters.communication_ps[:, :n_bins]
    edges = np.minimum(np.arange(n_bins + 1) * bin_ps, result.makespan_ps)
    resident = resident_bytes(workload, point.placement, run.all_resident)
    finished = counters.finished[:n_bins]
    largest = int(np.flatnonzero(counters.sizes.any(axis=0)).max(initial=0))
    return Motion(
        title=run.parameters.title,
        topology=topology,
        makespan_ps=result.makespan_ps,
        bin_ps=bin_ps,
        compute_ps=compute_ps,
        communication_ps=communication_ps,
        waiting_ps=np.diff(edges) - compute_ps - communication_ps,
        finished=finished,
        marks_ps=marks_of(finished, edges),
        batches=counters.batches[:, :n_bins],
        messages=counters.messages,
        bytes=counters.bytes,
        sizes=counters.sizes[:, : largest + 1],
        hops=hops_of(topology, counters.messages),
        link_bytes=topology.by_link(bytes_over_links(topology, counters.bytes)),
        load=counters.load_ps / max(result.makespan_ps, 1),
        resident_bytes=resident,
        transient_bytes=result.pe_peak_object_bytes - resident,
        queue_bytes=result.pe_peak_rays * machine.ray_bytes,
        peak_bytes=result.pe_peak_bytes,
        pixel_cost_ps=pixel_costs(point),
        pixel_hops=pixel_hops(point, result),
        pixel_owner=pixel_owners(point),
        fullest=fullest_of(point, run, n_bins),
        picture=picture,
    )


def marks_of(finished: Ints, edges_ps: Ints) -> dict[int, int]:
    """When 95, 99 and 100 % of the rays were finished: per cent to ps."""
    done = np.cumsum(finished)
    needed = {share: -(-int(done[-1]) * share // 100) for share in MARKS}
    return {s: int(edges_ps[1 + np.searchsorted(done, n)]) for s, n in needed.items()}


def bytes_over_links(topology: Topology, traffic: Ints) -> Ints:
    """Bytes over each link and port, of the bytes (nb, nb) from PE to PE."""
    total = np.zeros(topology.n_links, np.int64)
    _add_over_links(network_of(topology), traffic, total)
    return total


@njit
def _add_over_links(network: Network, traffic: Ints, total: Ints) -> None:
    for source in range(len(traffic)):
        for destination in range(len(traffic)):
            n_bytes = traffic[source, destination]
            here = enter(network, source, destination)[0] if n_bytes > 0 else destination
            while here != destination:
                link, here, _, _ = next_link(network, source, here, destination, 0, 0)
                total[link] += n_bytes


def hops_of(topology: Topology, messages: Ints) -> Ints:
    """How many of the messages (nb, nb) crossed 0, 1, ... links."""
    counts = np.zeros(topology.diameter + 1, np.int64)
    _count_hops(network_of(topology), messages, counts)
    return counts


@njit
def _count_hops(network: Network, messages: Ints, counts: Ints) -> None:
    for source in range(len(messages)):
        for destination in range(len(messages)):
            counts[hops(network, source, destination)] += messages[source, destination]


def pixel_costs(point: Point) -> Ints:
    """What the tests and rays of each pixel's tree cost: (rows, columns) ps."""
    workload, machine = point.workload, point.machine
    test_ps = machine.test.of_objects(workload)[workload.itinerary_objects]
    if len(workload.ray_test_scales):
        test_ps <<= np.repeat(workload.ray_test_scales, np.diff(workload.itinerary_offsets))
    before_ps = np.concatenate([[0], np.cumsum(test_ps, dtype=np.int64)])
    ray_ps = np.diff(before_ps[workload.itinerary_offsets]) + machine.ray_ps
    return _by_pixel(point, ray_ps)


def pixel_owners(point: Point) -> Ints:
    """The PE that each pixel starts on: (rows, columns)."""
    first_pass = point.placement.pixel_pes[: point.workload.n_pixels]
    return first_pass.astype(np.int64).reshape(point.workload.picture)


def pixel_hops(point: Point, result: Result) -> Ints:
    """Links crossed for the rays of each pixel's tree: (rows, columns)."""
    rays = result.ray_hops
    return _by_pixel(point, np.zeros(point.workload.n_rays, np.int64) if rays is None else rays)


def _by_pixel(point: Point, of_rays: NDArray[np.integer]) -> Ints:
    """Sums over the rays of each pixel's tree."""
    workload = point.workload
    total = np.zeros(workload.n_pixels, np.int64)
    np.add.at(total, workload.pixels % workload.n_pixels, of_rays)
    return total.reshape(workload.picture)
