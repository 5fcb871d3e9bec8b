"""Replicas that take what a capacity leaves (``memory.fraction: fill``)."""

from __future__ import annotations

import numpy as np
import pytest

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.engine.capacity import Needs, needs_of, split
from simmpp.engine.filling import effective_fraction, filled
from simmpp.placement.placement import Placement
from simmpp.placement.rooms import Capacity, Room
from simmpp.policy.parameters import PolicyParameters

WORKLOAD = simmpp.trace(simmpp.load_scene("mountain:3"), simmpp.Picture(resolution=8))
MACHINE = simmpp.make_machine(processors=4)
OBJECT, RAY = PolicyParameters("object"), PolicyParameters("ray")


def placed(capacity: str, **memory: object) -> Placement:
    """Four PEs whose memory replicas fill."""
    room = simmpp.Memory(fraction="fill", capacity=capacity, **memory)  # type: ignore[arg-type]
    return simmpp.place(WORKLOAD, 4, room, simmpp.PlacementRules(), seed=5)


def full(placement: Placement, policy: PolicyParameters) -> Placement:
    """The placement of a policy."""
    needs = needs_of(WORKLOAD, MACHINE, placement, policy)
    return filled(WORKLOAD, placement, needs)[0]


def test_by_hand() -> None:
    # Of 1000 bytes 100 are its own, 50 for escapes, 10 for requests: 840 are left. A quarter is for
    # rays, 252 and 168 for what comes and what is fetched, and 210 for replicas.
    one = np.array([100]), np.array([50])
    needs = Needs(*one, 10, 30, 40, True, True, np.zeros(0, np.int32), fills=True)
    bounds = Capacity(1000, buffers=Room(252), fetch=Room(168))
    parts = split(needs, bounds, 1000)
    assert [int(of[0]) for of in (parts.queue, parts.receive, parts.fetch)] == [210, 252, 168]
    assert parts.replicas.tolist() == [210]
    # Of 232 bytes 72 are left. The quarter is less than the largest tree, 30 bytes; the receipt has
    # its least, 40; of the other two one is for what is fetched, and one for replicas.
    parts = split(needs, Capacity(232, buffers=Room(0), fetch=Room(1)), 232)
    assert [int(of[0]) for of in (parts.queue, parts.receive, parts.fetch)] == [30, 40, 1]
    assert parts.replicas.tolist() == [1]
    # Where the least for what comes is more than three quarters, the rays have the rest.
    wide = Needs(*one, 10, 5, 600, True, True, np.zeros(0, np.int32), fills=True)
    parts = split(wide, bounds, 860)
    assert [int(of[0]) for of in (parts.queue, parts.receive, parts.fetch)] == [100, 600, 0]


def test_replicas_are_the_first_of_one_order_whatever_policy_and_capacity() -> None:
    placements = [full(placed(c), of) for c in ("10 kB", "14 kB") for of in (OBJECT, RAY)]
    orders = [p.replica_objects[: p.replica_offsets[1]].tolist() for p in placements]
    longest = max(orders, key=len)
    assert all(order == longest[: len(order)] for order in orders)
    assert len({len(order) for order in orders}) > 1
    assert all(p.filling is None for p in placements)


def test_each_policy_has_as_many_as_it_leaves_room_for() -> None:
    placement = placed("12 kB")
    shares = [effective_fraction(WORKLOAD, MACHINE, placement, of) for of in (OBJECT, RAY)]
    assert all(0.25 < share < 1 for share in shares)
    result = simmpp.simulate(WORKLOAD, MACHINE, placement, OBJECT)
    there = full(placement, OBJECT)
    use, own = result.memory, placement.effective_fraction
    assert use is not None
    assert use.peak_resident <= 12_000
    assert own < there.effective_fraction == shares[0]
    everything = PolicyParameters("replicated")
    assert effective_fraction(WORKLOAD, MACHINE, placed("1 MB"), everything) == 1.0


def test_as_many_are_kept_as_are_resident_if_that_is_wanted() -> None:
    there = full(placed("12 kB", transient="x"), OBJECT)
    assert there.transient == round(there.effective_fraction * WORKLOAD.n_objects)
    assert full(placed("12 kB", transient=3), OBJECT).transient == 3


def test_without_a_capacity_there_is_nothing_to_fill() -> None:
    memory, config = simmpp.Memory(fraction="fill"), {"scene": "mountain:3", "processors": 4}
    with pytest.raises(ConfigError, match="memory: fraction: value 'fill': expected a capacity"):
        simmpp.place(WORKLOAD, 4, memory, simmpp.PlacementRules(), 0)
    with pytest.raises(ConfigError, match=r"memory\.fraction: value 'fill': expected a capacity"):
        simmpp.sweep({**config, "memory": {"fraction": "fill"}})


def test_rows_say_how_much_was_filled() -> None:
    rows = simmpp.sweep(
        {
            "scene": "mountain:3",
            "picture": {"resolution": 8},
            "processors": 4,
            "memory": {"fraction": "fill"},
            "policy": ["object", "ray"],
            "sweep": {"memory.capacity": ["12 kB", "100 kB"]},
        }
    ).rows
    assert set(rows["fraction"].isna()) == {True}
    shares = rows.set_index(["policy", "memory.capacity"])["effective_fraction"]
    assert shares["object", "100 kB"] == shares["ray", "100 kB"] == 1
    assert 0.25 < shares["object", "12 kB"] < 1


def test_the_model_knows_shares_only() -> None:
    config = {
        "scene": "mountain:3",
        "picture": {"resolution": 8},
        "processors": 4,
        "method": "analytical",
        "policy": ["object", "ray"],
        "memory": {"fraction": "fill", "capacity": "100 kB"},
    }
    with pytest.raises(ConfigError, match=r"knows shares: expected memory\.fraction, a share"):
        simmpp.sweep(config)
