"""The torus against SimGrid's: ways, times of single messages, last completions of several.

SimGrid lets messages share the bandwidth of a link, simmpp serves one after the other. What begins
together and shares a link ends at different times then, but the last of them at the same one, give
or take the latency of the hops that one way has more than the other.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from by_hand import MACHINE, OBJECT, case_of
from implementations import IMPLEMENTATIONS, run
from oracles.hop_by_hop import Sent
from oracles.network import links
from traffic import arrivals_ps

from simmpp.machine.machine import CopyCost
from simmpp.machine.torus import CONTENTIONS, hops
from simmpp.machine.transfer import PS_PER_S, transfer_ps

SIMGRID = json.loads(
    (Path(__file__).parents[1] / "golden" / "simgrid" / "torus.json").read_text(encoding="utf-8")
)
SHAPE = tuple(SIMGRID["shape"])
HOP_PS = round(SIMGRID["hop_latency_s"] * PS_PER_S)
BYTES_PER_S = SIMGRID["link_bytes_per_s"]
FREE = (CopyCost(0),) * 4
ONE_WAY = [
    (*map(int, key.split(",")), seconds)
    for key, seconds in SIMGRID["one_way_s"].items()
    if not key.startswith("0,")  # SimGrid's loopback: PEs here send nothing to themselves
]


def picoseconds(seconds: float) -> int:
    """SimGrid's floats, which are exact to 1e-15 s."""
    return round(seconds * PS_PER_S)


def test_hops_are_simgrids() -> None:
    for n_hops, node in SIMGRID["destination_from_0_by_hops"].items():
        assert hops(*SHAPE, 0, node) == int(n_hops)


@pytest.mark.parametrize("contention", CONTENTIONS)
@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_message_alone_takes_simgrids_time(implementation: str, contention: str) -> None:
    assert len(ONE_WAY) == 24
    for n_hops, n_bytes, seconds in ONE_WAY:
        node = SIMGRID["destination_from_0_by_hops"][str(n_hops)]
        case = case_of(  # a request that is sent at 0
            OBJECT,
            [(0, [1])],
            owners=(0, node),
            shape=SHAPE,
            contention=contention,
            send_startup_ps=0,
            probe_ps=0,
            pack=FREE,
            header_bytes=0,
            request_bytes=n_bytes,
            latency_ps=0,
            hop_latency_ps=HOP_PS,
            link_bytes_per_s=BYTES_PER_S,
        )
        arrival_ps, destination, *_ = run(implementation, case).arrivals[0]
        exact_ps = n_hops * HOP_PS + n_bytes * PS_PER_S // BYTES_PER_S
        assert (arrival_ps, destination) == (picoseconds(seconds), node)
        assert arrival_ps == exact_ps


def test_halfway_round_a_ring_the_direction_is_ours() -> None:
    ours = {}
    for way in SIMGRID["direction_at_half_a_ring_of_4"]:
        source, destination = map(int, way.split(" to "))
        ours[way] = {name[-1] for name in links(SHAPE, source, destination)}
    differs = {way for way, signs in SIMGRID["direction_at_half_a_ring_of_4"].items()
               if ours[way] != set(signs)}  # fmt: skip
    assert differs == {"2 to 0"}


@pytest.mark.parametrize("name", SIMGRID["together"])
def test_the_last_of_several_ends_when_simgrids_does(name: str) -> None:
    messages = SIMGRID["together"][name]["source_destination_bytes_start_s"]
    elapsed_s = SIMGRID["together"][name]["elapsed_s"]
    ours = arrivals_of(messages)
    theirs = [
        picoseconds(message[3]) + picoseconds(elapsed)
        for message, elapsed in zip(messages, elapsed_s, strict=True)
    ]
    most_hops = max(hops(*SHAPE, source, destination) for source, destination, *_ in messages)
    assert 0 <= max(ours) - max(theirs) <= (most_hops - 1) * HOP_PS
    assert all(
        mine <= their for mine, their in zip(sorted(ours)[:-1], sorted(theirs), strict=False)
    )
    if most_hops == 1:
        assert max(ours) == max(theirs)


def test_links_carry_simgrids_bytes() -> None:
    # Two messages on one link: as many bytes by the end of the last one, at the full bandwidth
    for name in ("c2_same_pair", "c2_staggered_1ms"):
        messages = SIMGRID["together"][name]["source_destination_bytes_start_s"]
        last_ps = max(arrivals_of(messages))
        n_bytes = sum(message[2] for message in messages)
        assert last_ps - HOP_PS == n_bytes * PS_PER_S // BYTES_PER_S


def arrivals_of(messages: list[tuple[int, int, int, float]]) -> list[int]:
    """When ours arrive: of (source, destination, bytes, start in s), in the order of departures."""
    machine = replace(MACHINE, shape=SHAPE, latency_ps=0, hop_latency_ps=HOP_PS)
    traffic = [
        Sent(picoseconds(start_s), source, n, destination, transfer_ps(n_bytes, BYTES_PER_S))
        for n, (source, destination, n_bytes, start_s) in enumerate(messages)
    ]
    return arrivals_ps(machine, traffic).tolist()
