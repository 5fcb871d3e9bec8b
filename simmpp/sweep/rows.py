"""``results.csv``: one row per policy, with the columns that every later step reads."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from simmpp.sweep.point import Point, PolicyRun

KEYS = ("scene", "processors", "fraction", "effective_fraction", "policy", "seed")
NUMBERS = (
    "makespan_ps",
    "messages",
    "request_messages",
    "object_messages",
    "ray_messages",
    "load_messages",
    "bytes_sent",
    "rays",
    "tests",
    "rays_sent",
    "objects_fetched",
    "compute_ps",
    "communication_ps",
    "waiting_ps",
    "peak_rays",
    "peak_bytes",
    "events",
)
"""Integers of a result; times of PEs are sums over them."""
COLUMNS = (*KEYS, "method", "engine", *NUMBERS, "error")

Row = dict[str, object]


def numbers(run: PolicyRun) -> dict[str, int]:
    """The integers of a run, by column."""
    values = {column: np.atleast_1d(getattr(run.result, column)) for column in NUMBERS}
    return {column: sum(value.tolist()) for column, value in values.items()}


def row(point: Point, run: PolicyRun) -> Row:
    """The row of one policy at one point; a memory given in bytes has no fraction."""
    memory = point.config.memory
    effective = 1.0 if run.all_resident else point.placement.effective_fraction
    return {
        "scene": point.workload.name,
        "processors": point.machine.processors,
        "fraction": "" if memory.bytes is not None else float(memory.fraction),
        "effective_fraction": effective,
        "policy": run.parameters.title,
        "seed": point.seed,
        "method": point.config.settings.method,
        "engine": run.result.engine,
        **numbers(run),
        "error": "",
    }


def write_rows(rows: Iterable[Row], path: Path) -> None:
    """Write rows sorted by their keys; equal rows give equal bytes."""
    ordered = sorted(rows, key=_order)
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(ordered)


def _order(row: Row) -> list[tuple[bool, object]]:
    """Numbers by size, before the empty text of what was not given."""
    return [(isinstance(row[key], str), row[key]) for key in KEYS]
