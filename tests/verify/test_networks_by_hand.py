"""Levels worked out by hand, on the oracle and both engines; and what can't be a network.

Nodes of 2 PEs, groups of 3 nodes, a system of 14 PEs: the last group has one node, of 2.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from by_hand import MACHINE, OBJECT, case_of
from implementations import IMPLEMENTATIONS, run
from oracles.hop_by_hop import HopByHop, Sent
from traffic import arrivals_ps

from simmpp.common.errors import ConfigError
from simmpp.config.config import config_from_mapping
from simmpp.machine.machine import CopyCost, Level, Machine
from simmpp.machine.presets import OVERRIDDEN, machine
from simmpp.machine.topology import topology_of
from simmpp.machine.torus import CONTENTIONS

A_BYTE_A_PS = 10**12
NODE = Level("node", 2, latency_ps=5, bytes_per_s=A_BYTE_A_PS)
GROUP = Level("group", 3, latency_ps=20, bytes_per_s=A_BYTE_A_PS // 2, ports=2)
SYSTEM = Level("system", 0, latency_ps=100, bytes_per_s=A_BYTE_A_PS // 10, gap_ps=2000)
LEVELS: dict[str, Any] = {"topology": "levels", "levels": (NODE, GROUP, SYSTEM)}
SHAPE = (14, 1, 1)


@pytest.mark.parametrize("contention", CONTENTIONS)
@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize(
    ("other", "flight_ps"),
    [(1, 5 + 100), (2, 20 + 200), (5, 20 + 200), (6, 100 + 1000), (13, 100 + 1000)],
)
def test_100_bytes_take_what_their_level_says(
    implementation: str, contention: str, other: int, flight_ps: int
) -> None:
    case = case_of(  # a request that is sent at 0
        OBJECT,
        [(0, [1])],
        owners=(0, other),
        shape=SHAPE,
        contention=contention,
        send_startup_ps=0,
        probe_ps=0,
        pack=(CopyCost(0),) * 4,
        header_bytes=0,
        request_bytes=100,
        **LEVELS,
    )
    arrival_ps, destination, *_ = run(implementation, case).arrivals[0]
    assert (arrival_ps, destination) == (flight_ps, other)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize(("other", "makespan_ps"), [(1, 1710), (6, 2620)])
def test_a_fetch_pays_the_startups_of_its_level(
    implementation: str, other: int, makespan_ps: int
) -> None:
    # node    request 1 + 3 + 2 = 6, there 5 + 12: 23; received 4 + 6: 33; answered 3 + 53: 89,
    #         there 5 + 54: 148; received 4 + 57: 209; probe, test and ray 1501: 1710
    # system  1 + 30 + 2 = 33, 100 + 120: 253; 40 + 6: 299; 30 + 53: 382, 100 + 540: 1022;
    #         40 + 57: 1119; 1501: 2620
    startups = {"send_startup_ps": 3, "receive_startup_ps": 4}
    node = replace(NODE, **startups)
    system = replace(SYSTEM, **{name: 10 * ps for name, ps in startups.items()})
    levels = {**LEVELS, "levels": (node, GROUP, system)}
    case = case_of(OBJECT, [(0, [1])], owners=(0, other), shape=SHAPE, **levels)
    assert run(implementation, case).makespan_ps == makespan_ps


def arrivals(*messages: tuple[int, int, int, int]) -> list[int]:
    """When (departure, source, destination, bytes) arrive, as the oracle says too."""
    here = replace(MACHINE, shape=SHAPE, **LEVELS)
    traffic = [Sent(at, a, n, b, n_bytes) for n, (at, a, b, n_bytes) in enumerate(messages)]
    found = arrivals_ps(here, traffic).tolist()
    expected = HopByHop(here, traffic).arrivals_ps
    assert found == [expected[n] for n in range(len(traffic))]
    return [int(ps) for ps in found]


def test_each_pe_of_a_node_has_its_own_port_where_there_are_two() -> None:
    # PE 0 and PE 1 leave node 0 by ports 0 and 1, and enter node 1 by the ports of PE 2 and PE 3
    assert arrivals((0, 0, 2, 100), (0, 1, 3, 100)) == [220, 220]
    # both enter by the port of PE 2, busy for 200, then its own: the bytes take 200 once more
    assert arrivals((0, 0, 2, 100), (0, 1, 2, 100)) == [220, 420]


def test_the_port_of_a_group_is_shared_and_has_a_gap() -> None:
    # Out of group 0 by its one port: 1000 for 100 bytes, 2000 by the gap, from node ports at 0
    # PE 0 -> 6: 0 + latency 100 + 1000; PE 2 -> 8: 2000 + 100 + 1000
    assert arrivals((0, 0, 6, 100), (0, 2, 8, 100)) == [1100, 3100]
    # Within its group PE 1 does not wait for that: out of node 0 by port 1
    assert arrivals((0, 0, 6, 100), (0, 1, 3, 100)) == [1100, 220]
    # but PE 0's second message waits for its first one's 200 at the port of the node
    assert arrivals((0, 0, 6, 100), (0, 0, 2, 100)) == [1100, 200 + 20 + 200]


# --- as users write them ---


def made(levels: dict[str, Any], preset: str = "t3e", processors: int = 16, **more: Any) -> Machine:
    return machine(preset, {"levels": levels, **more}, processors)


def test_a_level_has_what_it_says_and_the_machines_otherwise() -> None:
    whole_of = {"bandwidth": "1 GB/s", "receive_startup": "3 us"}
    found = made({"node": {"size": 4, "latency": "1 us"}, "all": whole_of})
    assert found.topology == "levels" and found.processors == 16
    node, whole = found.levels
    startups = {"send_startup_ps": 10**7, "receive_startup_ps": 2 * 10**7}
    assert node == Level("node", 4, latency_ps=10**6, bytes_per_s=340 * 10**6, **startups)
    startups["receive_startup_ps"] = 3 * 10**6
    assert whole == Level("all", 0, latency_ps=2 * 10**6, bytes_per_s=10**9, **startups)
    assert found.sources["levels.node.latency"] == OVERRIDDEN
    assert "levels.all.latency" not in found.sources
    assert str(topology_of(found)) == "node of 4, all of 4"


MISTAKES = [
    ({"levels": {}}, "machine.levels: value {}: expected the blocks from the inside out"),
    ({"levels": {"a.b": {}}}, "machine.levels: name 'a.b': expected letters, digits, - and _"),
    ({"levels": {"a": {"size": 2}}}, "machine.levels.a.size: value 2: expected room for 64 PEs"),
    ({"levels": {"a": {}, "b": {}}}, "machine.levels.a: missing key 'size'"),
    ({"levels": {"a": {"ports": 2}}}, "machine.levels.a.ports: value 2: expected none, for a PE"),
    ({"levels": {"a": {}}, "shape": [64, 1, 1]}, "machine.shape: it goes with topology torus"),
    ({"levels": {"a": {}}, "hop_latency": "1 ns"}, "machine.hop_latency: it goes with topology"),
    ({"levels": {"a": {}}, "topology": "torus"}, "machine.levels: it goes with topology levels"),
    ({"topology": "levels"}, "machine.levels: expected at least one level"),
    ({"fat_tree": {}}, "machine.fat_tree: missing key 'arity'"),
    ({"topology": "fat-tree"}, "machine.fat_tree: missing key 'arity'"),
    ({"fat_tree": {"arity": 1}}, "machine.fat_tree.arity: value 1: expected an integer from 2"),
    (
        {"fat_tree": {"arity": 4, "levels": 2}},
        "machine.fat_tree.levels: value 2: expected room for 64 PEs, not 4 ^ 2",
    ),
    (
        {"fat_tree": {"arity": 4, "oversubscription": 3}},
        "machine.fat_tree.oversubscription: value 3: expected a divisor of the arity 4",
    ),
    ({"fat_tree": {"arity": 4}, "levels": {"a": {}}}, "machine.fat_tree: it goes with topology"),
    ({"levels": {"a": {"latencyy": 0}}}, "machine.levels.a: unknown key 'latencyy'"),
]


@pytest.mark.parametrize(("settings", "line"), MISTAKES)
def test_what_can_be_no_network_is_refused_in_one_line(settings: dict[str, Any], line: str) -> None:
    with pytest.raises(ConfigError) as error:
        config_from_mapping({"scene": "mountain:3", "machine": settings})
    assert str(error.value).startswith(line) and "\n" not in str(error.value)


@pytest.mark.parametrize("method", ["analytical", "analytical-measured"])
def test_the_analytical_model_knows_the_torus_alone(method: str) -> None:
    settings = {"scene": "mountain:3", "policy": "ray", "method": method}
    config_from_mapping(settings)
    with pytest.raises(ConfigError, match=f"method: value '{method}': expected simulate where"):
        config_from_mapping({**settings, "machine": {"levels": {"all": {}}}})


def test_one_constant_of_a_level_can_be_swept() -> None:
    levels = {"node": {"size": 4}, "all": {}}
    sweep = {"machine.levels.all.latency": ["1 us", "2 us"]}
    config_from_mapping({"scene": "mountain:3", "machine": {"levels": levels}, "sweep": sweep})
