"""Times of messages on SimGrid's own fat-trees and nested clusters: what made networks.json.

    python networks.py > networks.json        # SimGrid 3.32 with its Python module (Debian 12)

Nothing of simmpp is used. Links are SPLITDUPLEX; the network model is CM02 without its limits.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import simgrid  # type: ignore[import-not-found]
from simgrid import Actor, Engine, Mailbox, this_actor

HEAD = '<?xml version="1.0"?>\n<!DOCTYPE platform SYSTEM "https://simgrid.org/simgrid.dtd">\n'
SIZES = (64, 65536, 1048576)
M = 1048576
LINK = {"bytes_per_s": 500_000_000, "hop_latency_s": 1e-7}
TREES = {  # arity, levels, oversubscription
    "4 2 1": "2;4,4;1,4;1,1",
    "4 2 2": "2;4,4;1,2;1,1",
    "2 3 1": "3;2,2,2;1,2,2;1,1,1",
    "4 3 4": "3;4,4,4;1,1,1;1,1,1",
}
BLOCKS: dict[str, Any] = {
    "nodes": 4,
    "pes_of_a_node": 4,
    "inner": {"bytes_per_s": 4_000_000_000, "link_latency_s": 1e-7},
    "outer": {"bytes_per_s": 250_000_000, "link_latency_s": 1e-6},
}
TOGETHER = {
    "same pair": [(0, 1), (0, 1)],
    "same pair, far": [(0, 5), (0, 5)],
    "from one": [(0, 4), (0, 6), (0, 7)],
    "into one": [(0, 7), (2, 7), (4, 7)],
    "from one switch or node to one place": [(0, 4), (1, 4)],
    "up, to even PEs": [(0, 4), (1, 6)],
    "up, to an even and an odd PE": [(0, 4), (1, 5)],
    "up and down, crossed": [(0, 4), (4, 0), (1, 6), (6, 1)],
    "down, from two": [(0, 6), (2, 7)],
    "neighbours in turn": [(0, 1), (1, 2), (2, 3), (3, 0)],
}
OPTIONS = [
    "--log=root.threshold:critical",
    "--cfg=network/model:CM02",
    "--cfg=network/TCP-gamma:0",
    "--cfg=network/weight-S:0",
    "--cfg=network/crosstraffic:0",
    "--cfg=network/latency-factor:1",
    "--cfg=network/bandwidth-factor:1",
]
Message = tuple[int, int, int]
"""Source, destination, bytes."""


def tree(parameters: str) -> str:
    """A platform of one fat-tree."""
    last = 1
    for down in parameters.split(";")[1].split(","):
        last *= int(down)
    return (
        f'{HEAD}<platform version="4.1"><cluster id="c" prefix="p" suffix="" radical="0-{last - 1}"'
        f' speed="1Gf" bw="{LINK["bytes_per_s"]}Bps" lat="{LINK["hop_latency_s"]}s"'
        f' topology="FAT_TREE" topo_parameters="{parameters}"/></platform>'
    )


def blocks() -> str:
    """A platform of clusters that are joined, each by one link of its own."""
    inner, outer = BLOCKS["inner"], BLOCKS["outer"]
    nodes, each = range(BLOCKS["nodes"]), BLOCKS["pes_of_a_node"]
    clusters = [
        f'<cluster id="n{i}" prefix="p" suffix="" radical="{i * each}-{(i + 1) * each - 1}"'
        f' speed="1Gf" bw="{inner["bytes_per_s"]}Bps" lat="{inner["link_latency_s"]}s"'
        f' router_id="r{i}"/>'
        for i in nodes
    ]
    links = [
        f'<link id="l{i}" bandwidth="{outer["bytes_per_s"]}Bps"'
        f' latency="{outer["link_latency_s"]}s" sharing_policy="SPLITDUPLEX"/>'
        for i in nodes
    ]
    routes = [
        f'<zoneRoute src="n{i}" dst="n{j}" gw_src="r{i}" gw_dst="r{j}" symmetrical="NO">'
        f'<link_ctn id="l{i}" direction="UP"/><link_ctn id="l{j}" direction="DOWN"/></zoneRoute>'
        for i in nodes
        for j in nodes
        if i != j
    ]
    start = f'{HEAD}<platform version="4.1"><zone id="all" routing="Full">'
    return "\n".join([start, *clusters, *links, *routes, "</zone></platform>"])


def arrivals(engine: Engine, sets: list[list[Message]]) -> list[list[int]]:
    """Picoseconds that the messages of each set take; the sets one after the other."""
    found = [[0] * len(messages) for messages in sets]
    hosts = {host.name: host for host in engine.all_hosts}

    def send(mailbox: str, n_bytes: int, start_s: float) -> None:
        this_actor.sleep_until(start_s)
        Mailbox.by_name(mailbox).put("x", n_bytes)

    def receive(mailbox: str, start_s: float, of_set: int, n: int) -> None:
        Mailbox.by_name(mailbox).get()
        found[of_set][n] = round((Engine.clock - start_s) * 1e12)

    for of_set, messages in enumerate(sets):
        start_s = 0.0 if of_set == 0 else float(of_set)
        for n, (source, destination, n_bytes) in enumerate(messages):
            box = f"{of_set} {n}"
            Actor.create("s", hosts[f"p{source}"], send, box, n_bytes, start_s)
            Actor.create("r", hosts[f"p{destination}"], receive, box, start_s, of_set, n)
    engine.run()
    return found


def measured(platform: str, n_pes: int) -> dict[str, Any]:
    """One message from PE 0 to each other, of each size; and the sets."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "platform.xml"
        path.write_text(platform, encoding="utf-8")
        engine = Engine(["networks", *OPTIONS])
        engine.load_platform(str(path))
    alone = [(0, pe, n_bytes) for pe in range(1, n_pes) for n_bytes in SIZES]
    together = {name: [(a, b, M) for a, b in pairs] for name, pairs in TOGETHER.items()}
    times = arrivals(engine, [*([m] for m in alone), *together.values()])
    return {
        "one_way_ps": {f"{pe},{n}": t for (_, pe, n), (t,) in zip(alone, times, strict=False)},
        "together": {
            name: {"source_destination_bytes": messages, "elapsed_ps": elapsed}
            for (name, messages), elapsed in zip(together.items(), times[len(alone) :], strict=True)
        },
    }


def main() -> None:
    """One platform in each process: SimGrid has one engine in each."""
    if len(sys.argv) > 1:
        name = sys.argv[1]
        n_pes = 16 if name == "blocks" else int(name.split()[0]) ** int(name.split()[1])
        platform = blocks() if name == "blocks" else tree(TREES[name])
        print(json.dumps(measured(platform, n_pes)))
        return
    import subprocess

    found = {
        name: json.loads(subprocess.check_output([sys.executable, __file__, name]))
        for name in (*TREES, "blocks")
    }
    facts = {"simgrid": simgrid.simgrid_version, "link": LINK, "blocks": BLOCKS, "found": found}
    lines = ",\n".join(f" {json.dumps(key)}: {json.dumps(value)}" for key, value in facts.items())
    print(f"{{\n{lines}\n}}")


main()
