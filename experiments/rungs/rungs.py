"""Cheaper rungs than full simulation: their error against their cost.

    python experiments/rungs/rungs.py

Over figure 4's grid (and held-out scenes), profits of concurrent and ray dataflow over object
dataflow. The reference is the geometric mean of 27 seeds (12 for held-out scenes); its own variance
is taken off the squared errors. Cost is CPU time of object dataflow and the policy, the best of all
seeds for each run, in units of one seed of the scene's curve. Writes rungs.csv, a row per rung,
policy and scene, and its figure.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from string import ascii_uppercase
from textwrap import fill

import numpy as np
from rungs_runs import FIGURE4, HELD_OUT, all_runs, processors_of

from simmpp.common.files import write_csv
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.plot.matplotlib_panels import draw
from simmpp.studies.curve.estimate import Node, profits_at
from simmpp.studies.curve.smooth import smooth
from simmpp.studies.nebel98.figures import NAMES

HERE = Path(__file__).parent
CLOSE = 0.05
"""Half-width that the errors are compared with."""
MEASURES = {"time": "time profit", "messages": "message profit"}
SEEDS = (1, 2, 4, 8)
CHEAP_RUNS = 8
"""Cheap seeds of the control variate."""
LETTERS_ACROSS = 84
"""Characters of a line that says which letter is which rung."""

Row = dict[str, str | float]
Table = dict[tuple[str, Fraction], dict[int, np.ndarray]]
"""By kind and fraction, by seed: logarithms of time and message profit, CPU seconds."""
Errors = list[tuple[np.ndarray, np.ndarray]]
"""For each repetition logarithms of both profits, (2, x), and their standard errors or nan."""


def table_of(rows: list[dict[str, str]], scene: str, policy: str) -> Table:
    """The runs of one scene and policy."""
    found: dict[tuple[str, Fraction, int], dict[str, dict[str, str]]] = defaultdict(dict)
    for row in rows:
        if row["scene"] == scene:
            key = (row["kind"], Fraction(row["fraction"]), int(row["seed"]))
            found[key][row["policy"]] = row
    table: Table = defaultdict(dict)
    for (kind, x, seed), of in found.items():
        base, run = of["object"], of[policy]
        time = math.log(int(base["makespan_ps"]) / int(run["makespan_ps"]))
        messages = math.log(max(int(base["messages"]), 1) / max(int(run["messages"]), 1))
        cpu_s = float(base["cpu_s"]) + float(run["cpu_s"])
        table[kind, x][seed] = np.array([time, messages, cpu_s])
    return table


def seeds_of(table: Table, kind: str) -> tuple[list[Fraction], np.ndarray]:
    """The fractions of a kind, and its runs as (seeds, fractions, 3)."""
    xs = sorted(x for name, x in table if name == kind)
    seeds = sorted(table[kind, xs[0]]) if xs else []
    return xs, np.array([[table[kind, x][seed] for x in xs] for seed in seeds])


def curves(table: Table, scene: str, replicates: int, shares: np.ndarray) -> Errors:
    """The rung ``curve``, as ``simmpp.studies.curve.estimate.estimate`` makes it of its runs."""
    xs, runs = seeds_of(table, "curve")
    found = []
    for at in range(0, len(runs) - replicates + 1, replicates):
        nodes = [
            Node(float(x), is_drawn(x, scene), *np.exp(run[:2]))
            for seed in runs[at : at + replicates]
            for x, run in zip(xs, seed, strict=True)
        ]
        time, time_error, messages, message_error = map(np.array, profits_at(shares, nodes))
        errors = np.array([time_error / time, message_error / messages])
        found.append((np.log([time, messages]), errors))
    return found


def is_drawn(x: Fraction, scene: str) -> bool:
    """Are there replicas? (rings:1 has fewer objects than PEs.)"""
    return x > Fraction(1, processors_of(scene)) or scene == "rings:1"


def smoothed(runs: np.ndarray, shares: np.ndarray, independent: bool) -> Errors:
    """One full seed per fraction, smoothed: the same seed along x, or another at each."""
    random, found = np.random.default_rng(0), []
    for seed in range(len(runs)):
        chosen = np.full(len(shares), seed)
        if independent:
            chosen = random.integers(0, len(runs), len(shares))
        points = runs[chosen, np.arange(len(shares)), :2]
        pairs = [smooth(shares, points[:, measure], shares) for measure in range(2)]
        found.append((np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])))
    return found


def corrected(runs: np.ndarray, cheap: np.ndarray) -> Errors:
    """One full seed, and the mean of cheap seeds less the cheap run of that seed: multilevel."""
    found = []
    for seed in range(len(runs)):
        others = (seed + np.arange(CHEAP_RUNS)) % len(cheap)
        found.append(plain(runs[seed] - cheap[seed] + cheap[others].mean(axis=0)))
    return found


def plain(run: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A run as it is: it does not know its error."""
    return run[:, :2].T, np.full((2, len(run)), np.nan)


def rungs_of(table: Table, scene: str) -> Iterator[tuple[str, float, Errors]]:
    """Each rung on one scene: name, cost, repetitions."""
    xs, full = seeds_of(table, "full")
    shares = np.array([float(x) for x in xs])
    one_s = full[:, :, 2].min(axis=0).sum()

    def cost_of(kind: str) -> float:
        return float(seeds_of(table, kind)[1][:, :, 2].min(axis=0).sum() / one_s)

    for n in (1, 2, 3):
        yield f"curve x {n}", n * cost_of("curve"), curves(table, scene, n, shares)
    yield "one seed, smoothed", 1.0, smoothed(full, shares, independent=False)
    yield "a seed per x, smoothed", 1.0, smoothed(full, shares, independent=True)
    runs = {kind: seeds_of(table, kind)[1] for kind, _ in list(table) if kind != "curve"}
    for kind in sorted(set(runs) - {"full"}):
        yield kind, cost_of(kind), [plain(run) for run in runs[kind]]
    if "pixels / 16" in runs:
        cheap = runs["pixels / 16"]
        cost = 1 + (CHEAP_RUNS * cost_of("pixels / 16"))
        yield f"full + {CHEAP_RUNS} x pixels / 16", cost, corrected(full, cheap)
        finer = runs["pixels / 4"]
        pairs = zip(finer, cheap, strict=False)
        cost = cost_of("pixels / 4") + cost_of("pixels / 16")
        yield "pixels extrapolated", cost, [plain(2 * a - b) for a, b in pairs]


def judged(table: Table, scene: str, policy: str) -> Iterator[Row]:
    """Rows of one scene and policy."""
    _, full = seeds_of(table, "full")
    truth, spread = full[:, :, :2].mean(axis=0).T, full[:, :, :2].std(axis=0, ddof=1).T
    own = spread**2 / len(full)
    for n in SEEDS:
        rms = spread / math.sqrt(n)
        within = np.vectorize(math.erf)(CLOSE / np.maximum(rms, 1e-9) / math.sqrt(2))
        yield row_of(scene, policy, f"full x {n}", n, rms, within, None)
    for rung, cost, repetitions in rungs_of(table, scene):
        errors = np.array([logs for logs, _ in repetitions]) - truth
        claims = np.array([claim for _, claim in repetitions])
        rms = np.sqrt(np.maximum((errors**2).mean(axis=0) - own, 0))
        within = (np.abs(np.expm1(errors)) <= CLOSE).mean(axis=0)
        drawn = spread > 1e-9
        covered = (np.abs(errors) <= 1.96 * np.sqrt(claims**2 + own))[:, drawn].mean()
        certain = None if np.isnan(claims).all() else covered
        yield row_of(scene, policy, rung, cost, rms, within, certain)


def row_of(
    scene: str,
    policy: str,
    rung: str,
    cost: float,
    rms: np.ndarray,
    within: np.ndarray,
    covered: float | None,
) -> Row:
    """Errors in percent; shares of estimates that are close, over all x and at the worst x."""
    row: Row = {"scene": scene, "policy": policy, "rung": rung, "cost": round(cost, 3)}
    for number, measure in enumerate(MEASURES):
        row[f"{measure}_worst"] = round(100 * float(rms[number].max()), 2)
        row[f"{measure}_median"] = round(100 * float(np.median(rms[number])), 2)
        row[f"{measure}_close"] = round(float(within[number].mean()), 3)
        row[f"{measure}_close_worst"] = round(float(within[number].min()), 3)
    row["covered"] = "" if covered is None else round(float(covered), 3)
    return row


def panel(rows: list[Row], measure: str) -> Panel:
    """The worst point of each scene of figure 4, concurrent dataflow; full runs are the lines."""
    chosen = [row for row in rows if row["scene"] in FIGURE4 and row["policy"] == "concurrent"]
    rungs = list(dict.fromkeys(row["rung"] for row in chosen if not is_full(row)))
    letters = dict(zip(rungs, ascii_uppercase, strict=False))
    curves = []
    for style, scene in enumerate(FIGURE4):
        own = [row for row in chosen if row["scene"] == scene]
        full = {float(row["cost"]): error_of(row, measure) for row in own if is_full(row)}
        curves.append(Curve(NAMES[scene], full, style=style))
        for row in own:
            if not is_full(row):
                cost = float(row["cost"])
                notes = {cost: letters[row["rung"]]}
                curves.append(Curve("_", {cost: error_of(row, measure)}, notes=notes, style=style))
    named = "; ".join(f"{letter} {rung}" for rung, letter in letters.items())
    return Panel(
        f"{MEASURES[measure]}; the line: 95 % of estimates are within 5 %",
        Scale("CPU time / one full seed of the curve", is_log=True),
        Scale("root mean square error at the worst x, %", is_log=True, limits=(0.7, 250)),
        curves,
        level=100 * CLOSE / 1.96,
        note=fill(named, LETTERS_ACROSS),
        legend="1, 2, 4, 8 full seeds",
    )


def is_full(row: Row) -> bool:
    """Full seeds, with which rungs are compared."""
    return "full x" in str(row["rung"])


def error_of(row: Row, measure: str) -> Spread:
    """The error at the worst x; 0.1 % is the least that is drawn."""
    return Spread(*[max(float(row[f"{measure}_worst"]), 0.1)] * 3)


def main() -> None:
    """Simulate what is missing, judge, draw."""
    runs, rows = all_runs(), list[Row]()
    for policy in ("concurrent", "ray"):
        for scene in (*FIGURE4, *HELD_OUT):
            rows += judged(table_of(runs, scene, policy), scene, policy)
    write_csv(rows, list(rows[0]), HERE / "rungs.csv")
    draw([panel(rows, measure) for measure in MEASURES], HERE / "rungs")


if __name__ == "__main__":
    main()
