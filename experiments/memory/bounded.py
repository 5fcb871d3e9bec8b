"""Rows of a sweep of this folder by point, and what was expected of them beside what came out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from simmpp.common.files import write_csv
from simmpp.common.units import byte_count
from simmpp.common.yamlfile import read_yaml
from simmpp.config.config import load_config
from simmpp.sweeps.sweep import run_sweep

HERE = Path(__file__).parent
EXPECTED: Any = read_yaml(HERE / "expected.yaml").data
CAPACITY, LEAST, UNBOUNDED = "memory.capacity", "least", "none"
MS = "ms"
PER_PE = ["compute_ps", "communication_ps", "waiting_ps"]
"""Whose sum is the makespan times the number of PEs."""


def points(name: str, keys: list[str], folder: Path) -> pd.DataFrame:
    """Points by their keys: geometric mean of the seeds' makespans, means of what else is known.

    Read from the table beside this file; if it is not there, simulated in ``folder``, which keeps
    what is finished, and written. What does not fit is not there.
    """
    table = HERE / f"{name}-points.csv"
    if not table.exists():
        rows = run_sweep(load_config(HERE / f"{name}.yaml"), out=folder).rows
        by_point(rows, keys).to_csv(table, lineterminator="\n", float_format="%.6g")
    return pd.read_csv(table, keep_default_na=False, na_values=[""]).set_index(keys)


def by_point(rows: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Means over seeds of rows as a sweep writes them."""
    others = [key for key in keys if key != CAPACITY]
    by_place = rows.groupby(others)["least_bytes"].max()
    rows = rows[rows["makespan_ps"].notna()].assign(
        log_ms=lambda of: np.log(of["makespan_ps"].astype(float) / 1e9),
        pes_ps=lambda of: of[PER_PE].astype(float).sum(axis=1),
    )
    groups = rows.groupby(keys, dropna=False)
    table = pd.DataFrame({MS: np.exp(groups["log_ms"].mean())})
    table[["messages", "escapes"]] = groups[["messages", "escapes"]].mean().astype(float)
    table["tests"] = groups["tests"].mean().astype(float)
    sums = groups[["stalled_send_ps", "pes_ps"]].sum().astype(float)
    table["lacks_credit"] = sums["stalled_send_ps"] / sums["pes_ps"]
    places = pd.MultiIndex.from_frame(table.reset_index()[others])
    table["least_bytes"] = by_place.reindex(places).to_numpy(float)
    return table


def in_bytes(capacity: str) -> float:
    """A capacity as rows have it; nan for words."""
    return float("nan") if capacity in (LEAST, UNBOUNDED, "") else float(byte_count(capacity))


def mean(ratios: pd.Series | list[float]) -> float:
    """The geometric mean; nan of nothing."""
    return float(np.exp(np.mean(np.log(np.asarray(ratios, float))))) if len(ratios) else np.nan


def write_outcomes(found: Mapping[str, float], name: str) -> None:
    """What was expected of these quantities beside what came out, as a table and printed."""
    rows = []
    for statement in EXPECTED["statements"]:
        value = found.get(statement["quantity"])
        if value is not None and not np.isnan(value):
            hit = "yes" if statement["low"] <= round(value, 3) <= statement["high"] else "no"
            keys = ("id", "quantity", "low", "high", "expected")
            told = {"found": round(value, 3), "within": hit}
            rows.append({key: statement[key] for key in keys} | told)
    write_csv(rows, list(rows[0]), HERE / f"{name}-expected.csv")
    for row in rows:
        print(*row.values(), sep="\t")
