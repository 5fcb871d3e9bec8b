"""Rows of a sweep that nobody simulated, for tests of what is made of rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from simmpp.common.files import Row, write_csv
from simmpp.engine.memory_use import COLUMNS as BOUNDS
from simmpp.engine.memory_use import REASON
from simmpp.methods.columns import NUMBERS, result_columns
from simmpp.run.rows import RESULTS, in_order

SPEED = {"object": 1.0, "ray": 0.5, "concurrent": 2.0, "replicated": 3.0}
"""Of a policy; others are as fast as object dataflow."""
HOSTILE = "<script>hacked=1</script><b>\"eager\" & 'lazy'</b> %{x}"
"""A label that harms a page which doesn't escape it."""


PEAKS = {
    name: n * 10
    for n, name in enumerate(
        ("peak_resident", "peak_fetched", "peak_ray_queue", "peak_receive"), start=1
    )
}
LACKS = {"fits": 0, "exceeds_bytes": 3 * 10**9, "least_bytes": 7 * 10**9}
UNFIT: Row = dict.fromkeys((*NUMBERS, *BOUNDS), "") | LACKS
"""What a policy that does not fit has for numbers."""


def row(policy: str = "object", seed: int = 0, **cells: Any) -> Row:
    """A row whose numbers differ from those of others, by policy, x and seed."""
    x = cells.get("fraction", 0.5)
    hurry = SPEED.get(policy, 1.0) * (1.5 - (x or 0.1)) * (1 + seed / 50)
    return {
        "scene": "mountain:4",
        "processors": 8,
        "fraction": x,
        "effective_fraction": 1.0 if policy == "replicated" else x or 0.1,
        "policy": policy,
        "seed": seed,
        "method": "simulate",
        "engine": "compiled",
        **dict.fromkeys(NUMBERS, 7),
        "makespan_ps": int(10**12 / hurry),
        "messages": 1952 + seed,
        "request_messages": 1000 + seed,
        "object_messages": 900,
        "ray_messages": 50,
        "load_messages": 2,
        "rays": 2**60 + seed,
        "compute_ps": 10**12,
        "communication_ps": 10**11 * (seed + 1),
        "waiting_ps": 3 * 10**11,
        "error": "",
    } | cells


def timed(policy: str, *makespans_ps: int, **cells: object) -> list[Row]:
    """Rows of one policy, one a seed, with these makespans."""
    return [row(policy, seed, makespan_ps=t, **cells) for seed, t in enumerate(makespans_ps)]


def failed(policy: str = "object", seed: int = 0, **cells: Any) -> Row:
    """A row with an error in place of numbers."""
    made = row(policy, seed, **cells)
    return made | dict.fromkeys((*NUMBERS, "effective_fraction"), "") | {"error": "took too long"}


def bounded(policy: str, makespan_ps: int | None, capacity: str, **cells: Any) -> Row:
    """A row with a capacity; without a makespan of what lacks 3 GB."""
    made = row(policy, fraction=0.1, **{"memory.capacity": capacity})
    made |= dict.fromkeys((*BOUNDS, REASON), "")
    if capacity != "null":
        made |= dict.fromkeys(BOUNDS, 0) | {"fits": 1} | PEAKS
    return made | ({"makespan_ps": makespan_ps} if makespan_ps else UNFIT) | cells


def sweep(
    policies: Sequence[str] = ("object", "ray", "concurrent", "replicated"),
    seeds: int = 3,
    **axes: Sequence[Any],
) -> list[Row]:
    """Rows of all combinations of the axes."""
    return [
        row(policy, seed, **dict(zip(axes, values, strict=True)))
        for values in product(*axes.values())
        for policy in policies
        for seed in range(seeds)
    ]


def written(
    folder: Path, rows: Iterable[Row], further: Sequence[str] = (), uses: Sequence[str] = ()
) -> Path:
    """The folder, with the rows as results.csv."""
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(in_order(rows, further), result_columns(further, uses), folder / RESULTS)
    return folder
