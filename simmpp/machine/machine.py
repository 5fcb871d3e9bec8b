"""The machine, in the integers that a simulation runs on: picoseconds, bytes, bytes per second.

A constant is declared here and nowhere else: its type says how users write it and in what range,
the text below it what it means, and its name is the key in YAML (``constants.key_of``). A further
one is a field here, a line in each preset, and its place of use.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from simmpp.common.documented import documented
from simmpp.common.quantities import Bandwidth, Power, Price, Size, Time
from simmpp.common.strict import Expect, integer, one_of, only
from simmpp.common.units import UNLIMITED as UNLIMITED
from simmpp.machine.uneven import MOST_PROCESSORS as MOST_PROCESSORS
from simmpp.machine.uneven import NOBODY, Noise, Speeds, Straggler
from simmpp.workload.workload import CONE, MESH, POLYGON, SPHERE, Workload


def is_shape(value: object) -> bool:
    """Are these three numbers of PEs?"""
    return (
        isinstance(value, list | tuple)
        and len(value) == 3
        and all(isinstance(n, int) and not isinstance(n, bool) for n in value)
        and all(1 <= n <= MOST_PROCESSORS for n in value)
    )


_SHAPE = "three positive integers, such as [4, 4, 4]"
_SIDES = {"type": "integer", "minimum": 1, "maximum": MOST_PROCESSORS}
_THREE = {"type": "array", "items": _SIDES, "minItems": 3, "maxItems": 3}
Shape = Annotated[tuple[int, int, int], *only(is_shape, Expect(_SHAPE, _THREE, "PEs"))]


TORUS, LEVELS, FAT_TREE = TOPOLOGY_NAMES = ("torus", "levels", "fat-tree")
POLLED, THREAD, NIC = SERVICES = ("pe", "thread", "nic")
MOST_LEVELS = 16


@documented
@dataclass(frozen=True)
class Level:
    """Blocks of PEs in larger blocks: what a message costs between two that are in one block."""

    name: str
    """The user's."""
    size: Annotated[int, *integer(1, MOST_PROCESSORS, "blocks")] = 0
    """Blocks of the level below that one of its blocks has (PEs, of the innermost level); the
    outermost has all there are when not given."""
    latency_ps: Time = 0
    """Of a message that goes no further out, the machine's when not given."""
    bytes_per_s: Bandwidth = UNLIMITED
    """Of such a message, and of each port, the lower of the machine's two when not given."""
    gap_ps: Time = 0
    """With contention: a message keeps a port of the level busy for that long at least, the
    machine's when not given."""
    ports: Annotated[int, *integer(1, MOST_PROCESSORS, "ports")] = 1
    """With contention: ways out, and in, of each block of the level below; its PE i has number i
    mod ports. A PE has one."""
    send_startup_ps: Time = 0
    """Sender's cost of such a message, the machine's when not given."""
    receive_startup_ps: Time = 0
    """Receiver's cost of such a message, the machine's when not given."""


@documented
@dataclass(frozen=True)
class FatTree:
    """How many switches of which kind a fat-tree has."""

    arity: Annotated[int, *integer(2, MOST_PROCESSORS, "links")] = 0
    """Links down from each switch."""
    levels: Annotated[int, *integer(1, MOST_LEVELS, "levels")] = 0
    """Of switches, as few as join all PEs when not given."""
    oversubscription: Annotated[int, *integer(1, MOST_PROCESSORS)] = 1
    """Links down for each link up, at every switch below the top; a divisor of the arity."""


@documented
@dataclass(frozen=True)
class CopyCost:
    """Cost of packing or unpacking one message of a kind: fixed + payload bytes / bandwidth."""

    fixed_ps: Time = 0
    """Part that does not depend on the size."""
    bytes_per_s: Bandwidth = UNLIMITED
    """Payload bytes copied per time."""


Copies = tuple[CopyCost, CopyCost, CopyCost, CopyCost]
"""Of each kind of message: request, object, rays, load."""
Levels = tuple[Level, ...]
"""The innermost first."""


@documented
@dataclass(frozen=True)
class TestCost:
    """Cost of one ray-object intersection, by kind of primitive."""

    __test__ = False  # not a test class, whatever pytest thinks of the name

    sphere_ps: Time
    """A test against a sphere."""
    cone_ps: Time
    """A test against a cone or cylinder."""
    polygon_ps: Time
    """A test against a polygon's first triangle."""
    mesh_ps: Time
    """A test against a mesh part's first triangle."""
    per_triangle_ps: Time = 0
    """For every triangle of a polygon or mesh beyond its first."""
    log2_ps: Time = 0
    """In place of `per_triangle`, for parts with a tree of their own: for every level of a tree of
    the triangles, log2 of their number rounded up."""

    def of_objects(self, workload: Workload, dtype: type = np.int64) -> NDArray[Any]:
        """Cost of a test against each object, its own where the workload gives one: (N,) ps."""
        if len(workload.object_test_ps):
            return workload.object_test_ps.astype(dtype)
        by_kind: NDArray[Any] = np.zeros(4, dtype)
        costs_ps = (self.sphere_ps, self.cone_ps, self.polygon_ps, self.mesh_ps)
        by_kind[[SPHERE, CONE, POLYGON, MESH]] = costs_ps
        cost_ps = by_kind[workload.object_kinds]
        if self.log2_ps:
            return cost_ps + self.log2_ps * depths(workload.object_triangles).astype(dtype)
        beyond_first = np.maximum(workload.object_triangles.astype(dtype) - 1, 0)
        return cost_ps + self.per_triangle_ps * beyond_first


def depths(triangles: NDArray[np.signedinteger[Any]]) -> NDArray[np.intp]:
    """log2 of numbers of triangles, rounded up: the least k with 2^k >= the number."""
    return np.searchsorted(1 << np.arange(63), triangles)


@documented
@dataclass(frozen=True)
class Machine:
    """Constants of one machine; ``shape`` says how many PEs it has.

    Copy costs are indexed by message kind: request, object, rays, load.
    """

    name: str
    """That of its preset."""
    shape: Shape
    """PEs along x, y, z of the torus, the most cubic when not given; PE k = x + X (y + Y z). Other
    topologies have none."""
    send_startup_ps: Time
    """Sender's cost of any message."""
    receive_startup_ps: Time
    """Receiver's cost of any message."""
    probe_ps: Time
    """Looking into an empty inbox before computing."""
    pack: Copies
    """Sender's copy of the payload."""
    unpack: Copies
    """Receiver's copy of the payload."""
    header_bytes: Size
    """Header of every message."""
    request_bytes: Size
    """Payload of a request."""
    ray_bytes: Size
    """One ray on the wire."""
    latency_ps: Time
    """Of the network, whatever the distance."""
    hop_latency_ps: Time
    """For each link a message crosses."""
    link_bytes_per_s: Bandwidth
    """Of one link, one way."""
    injection_bytes_per_s: Bandwidth
    """Between a PE and its router."""
    test: TestCost
    """One ray-object intersection: one time, or by kind of primitive."""
    ray_ps: Time
    """Set-up and shading of one ray."""
    quantum: Annotated[int, *integer(1, 2**31 - 1, "tests")]
    """Tests that a PE computes at most before it looks into its inbox."""
    compute_startup_ps: Time = 0
    """Cost of beginning to compute, whenever a PE does: the launch of a kernel."""
    least_tests: Annotated[int, *integer(0, 2**31 - 1, "tests")] = 0
    """Fewer tests at one go take as long as that many of their mean cost, and their rays are
    finished at the end: the lanes of an accelerator."""
    speed: Speeds = ()
    """Tests and rays take what they cost / speed; that of others is 1. By PEs, or by shares of them
    in turn: {25%: 2} is the first quarter."""
    noise: Noise = "0"
    """A go at computing takes a factor as long that is drawn with the seed: lognormal, with a mean
    of 1; the noise is the deviation of its logarithm."""
    straggler: Straggler = NOBODY
    """A PE that is late for a while."""
    topology: Annotated[str, *one_of(*TOPOLOGY_NAMES)] = TORUS
    """How PEs are joined: the way that `levels` or `fat_tree` says where one is given, else the
    preset's."""
    levels: Levels = ()
    """Blocks of PEs in larger blocks, the innermost first, each by a name of one's own."""
    fat_tree: FatTree = FatTree()
    """Switches of the fat-tree; its links have the machine's bandwidth and hop latency."""
    port_gap_ps: Time = 0
    """With contention: a message keeps the ports of its PEs busy for that long at least."""
    service: Annotated[str, *one_of(*SERVICES)] = POLLED
    """Who answers requests: the PE when it polls, a thread beside it, or the network card, of whom
    objects are got without the PE; the preset's when not given (see `machine.service`)."""
    handoff_ps: Time = 0
    """With a thread: the PE's cost of taking over a message that the thread has unpacked."""
    get_startup_ps: Time = 0
    """With nic: the PE's cost of starting a get, in place of sending a request."""
    completion_ps: Time = 0
    """With nic: the PE's cost of seeing what it has got, or what another has put into its memory,
    in place of the receive startup."""
    contention: Literal["none", "links"] = "none"
    """What messages wait for: nothing, or links and ports that serve one at a time."""
    power_mw: Power = field(default=0, compare=False)
    """Electricity that a PE takes with its share of its node, for what runs cost; not known when
    not given."""
    price_micros: Price = field(default=0, compare=False)
    """Of an hour of a PE likewise, in the one currency of all machines (the package's in USD)."""
    sources: dict[str, str] = field(default_factory=dict, compare=False)
    """Where each constant comes from, by its dotted key; values without a document say ESTIMATE."""

    @property
    def per_message_ps(self) -> int:
        """No message costs a PE more than this and its copy: ``limits`` counts on it."""
        of_levels = (level.send_startup_ps + level.receive_startup_ps for level in self.levels)
        startups_ps = max(self.send_startup_ps + self.receive_startup_ps, *of_levels, 0)
        one_sided_ps = self.handoff_ps + self.get_startup_ps + self.completion_ps
        return startups_ps + self.probe_ps + one_sided_ps

    @property
    def uses(self) -> tuple[str, ...]:
        """What its rows have columns of their own for."""
        uses = {"threads": self.service == THREAD, "is uneven": self.is_uneven}
        return tuple(use for use, it_does in uses.items() if it_does)

    @property
    def is_uneven(self) -> bool:
        """Does computing take anything else than the sum of what tests and rays cost?"""
        plain = self.compute_startup_ps == self.least_tests == 0 and not self.speed
        return not (plain and self.noise == "0" and self.straggler == NOBODY)

    @property
    def processors(self) -> int:
        """Number of PEs, nb in the paper."""
        x, y, z = self.shape
        return x * y * z
