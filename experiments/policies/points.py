"""Makespans of a sweep of this folder by point, and what was expected of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from shutil import copyfile
from typing import Any

import pandas as pd

from simmpp.common.files import write_csv
from simmpp.common.yamlfile import read_yaml
from simmpp.config.config import load_config, with_key
from simmpp.sweeps.sweep import run_sweep

HERE = Path(__file__).parent
POINT = ["scene", "processors", "fraction", "residents"]
RESIDENTS = "memory.residents"
BOUND = "bound"
MESH = "bunny.ply"
EXPECTED: Any = read_yaml(HERE / "expected.yaml").data


def makespans(name: str, folder: Path) -> pd.DataFrame:
    """Milliseconds of each policy (columns) at each point, the mean of the seeds.

    Read from the table beside this file; if it is not there, simulated in ``folder``, which keeps
    what is finished, and written.
    """
    table = HERE / f"{name}-points.csv"
    if not table.exists():
        _simulated(name, folder).to_csv(table, lineterminator="\n")
    return pd.read_csv(table, index_col=POINT)


def _simulated(name: str, folder: Path) -> pd.DataFrame:
    copyfile(str(files("pymeshfix") / "examples" / "StanfordBunny.ply"), HERE / MESH)
    config, rows = load_config(HERE / f"{name}.yaml"), []
    rules = {choice.assignments[RESIDENTS] for choice in config.axes[RESIDENTS]}
    for residents in sorted(map(str, rules)):
        part = with_key(config, f"sweep.{RESIDENTS}", [residents])
        if residents != "random":  # nothing is drawn, so all seeds are one
            part = with_key(part, "seeds", [0])
        rows.append(run_sweep(part, out=folder / residents).rows.assign(residents=residents))
    return by_point(pd.concat(rows))


def by_point(rows: pd.DataFrame) -> pd.DataFrame:
    """Means over seeds of rows as a sweep writes them."""
    rows = rows.assign(ms=rows["makespan_ps"] / 1e9)
    rows[BOUND] = rows["compute_ps"] / rows["processors"] / 1e9
    table = rows.pivot_table(index=POINT, columns="policy", values="ms", aggfunc="mean")
    table[BOUND] = rows[rows["policy"] == "object"].groupby(POINT)[BOUND].mean()
    return table.round(4)


def of_scenes(table: pd.DataFrame, scenes: Iterable[str]) -> pd.DataFrame:
    """The points of some scenes."""
    return table[table.index.get_level_values("scene").isin(list(scenes))]


def with_processors(table: pd.DataFrame, processors: int) -> pd.DataFrame:
    """The points with that many PEs."""
    return table[table.index.get_level_values("processors") == processors]


def mean(ratios: pd.Series) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, ratios)) / len(ratios))


def write_outcomes(found: Mapping[str, float], name: str) -> None:
    """What was expected of these quantities beside what came out, as a table and printed."""
    rows = []
    for statement in EXPECTED["statements"]:
        quantity = statement["quantity"]
        if quantity in found:
            value = round(found[quantity], 3)
            hit = "yes" if statement["low"] <= value <= statement["high"] else "no"
            keys = ("id", "quantity", "low", "high", "expected")
            rows.append({key: statement[key] for key in keys} | {"found": value, "within": hit})
    write_csv(rows, list(rows[0]), HERE / f"{name}-expected.csv")
    for row in rows:
        print(*row.values(), sep="\t")
