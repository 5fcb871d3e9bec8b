"""Fat-trees and levels against SimGrid's: times of single messages, last completions of several.

As on the torus (``test_simgrid_torus``) SimGrid shares the bandwidth of a link and simmpp serves
one after the other, so what ends last ends at the same time; here all ways of a set are as long.
SimGrid's clusters have a latency for each link, simmpp's levels one for the whole way.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from by_hand import MACHINE, OBJECT, case_of
from implementations import IMPLEMENTATIONS, run
from oracles.hop_by_hop import Sent
from traffic import arrivals_ps

from simmpp.machine.machine import CopyCost, FatTree, Level
from simmpp.machine.torus import CONTENTIONS
from simmpp.machine.transfer import PS_PER_S, transfer_ps

SIMGRID = json.loads(
    (Path(__file__).parents[1] / "golden" / "simgrid" / "networks.json").read_text("utf-8")
)
FOUND: dict[str, Any] = SIMGRID["found"]
BLOCKS = SIMGRID["blocks"]
FREE = (CopyCost(0),) * 4


def ps(seconds: float) -> int:
    return round(seconds * PS_PER_S)


def tree(name: str) -> dict[str, Any]:
    """The fields of a fat-tree of (arity, levels, oversubscription)."""
    shape = FatTree(*map(int, name.split()))
    return {
        "topology": "fat-tree",
        "shape": (shape.arity**shape.levels, 1, 1),
        "fat_tree": shape,
        "latency_ps": 0,
        "hop_latency_ps": ps(SIMGRID["link"]["hop_latency_s"]),
        "link_bytes_per_s": SIMGRID["link"]["bytes_per_s"],
    }


def levels() -> dict[str, Any]:
    """The fields of PEs in nodes: two links within a node, four from one node to another."""
    inner, outer = BLOCKS["inner"], BLOCKS["outer"]
    within_ps = 2 * ps(inner["link_latency_s"])
    beyond_ps = within_ps + 2 * ps(outer["link_latency_s"])
    node = Level("node", BLOCKS["pes_of_a_node"], within_ps, inner["bytes_per_s"])
    return {
        "topology": "levels",
        "shape": (BLOCKS["nodes"] * BLOCKS["pes_of_a_node"], 1, 1),
        "levels": (node, Level("all", 0, beyond_ps, outer["bytes_per_s"])),
    }


def fields(name: str) -> dict[str, Any]:
    return levels() if name == "blocks" else tree(name)


@pytest.mark.parametrize("contention", CONTENTIONS)
@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize("name", FOUND)
def test_a_message_alone_takes_simgrids_time(
    name: str, implementation: str, contention: str
) -> None:
    one_way_ps = FOUND[name]["one_way_ps"]
    assert len(one_way_ps) >= 21
    for key, theirs_ps in one_way_ps.items():
        pe, n_bytes = map(int, key.split(","))
        case = case_of(  # a request that is sent at 0
            OBJECT,
            [(0, [1])],
            owners=(0, pe),
            contention=contention,
            send_startup_ps=0,
            probe_ps=0,
            pack=FREE,
            header_bytes=0,
            request_bytes=n_bytes,
            **fields(name),
        )
        arrival_ps, destination, *_ = run(implementation, case).arrivals[0]
        assert (arrival_ps, destination) == (theirs_ps, pe)


SETS = [(name, which) for name in FOUND for which in FOUND[name]["together"]]


@pytest.mark.parametrize(("name", "which"), SETS)
def test_the_last_of_several_ends_when_simgrids_does(name: str, which: str) -> None:
    together = FOUND[name]["together"][which]
    machine = replace(MACHINE, **fields(name))
    rate = machine.link_bytes_per_s
    traffic = [
        Sent(0, source, n, destination, n_bytes if name == "blocks" else transfer_ps(n_bytes, rate))
        for n, (source, destination, n_bytes) in enumerate(together["source_destination_bytes"])
    ]
    ours, theirs = arrivals_ps(machine, traffic).tolist(), together["elapsed_ps"]
    assert max(ours) == max(theirs)
    assert all(mine <= their for mine, their in zip(sorted(ours), sorted(theirs), strict=True))


def test_links_are_shared_by_messages_that_do_not_share_a_pe() -> None:
    """Else the sets would say nothing of the ways."""
    alone = {name: FOUND[name]["one_way_ps"]["4,1048576"] for name in FOUND}
    for name in ("4 2 2", "4 3 4", "blocks"):
        assert max(FOUND[name]["together"]["up, to even PEs"]["elapsed_ps"]) > 1.9 * alone[name]
    apart = FOUND["4 2 2"]["together"]["up, to an even and an odd PE"]["elapsed_ps"]
    assert max(apart) == alone["4 2 2"]
