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

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from rungs_runs import FIGURE4, HELD_OUT, all_runs, processors_of

from simmpp.common.files import write_csv
from simmpp.studies.curve.estimate import Node, profits_at
from simmpp.studies.curve.smooth import smooth

HERE = Path(__file__).parent
CLOSE = 0.05
"""Half-width that the errors are compared with."""
SEEDS = (1, 2, 4, 8)
CHEAP_RUNS = 8
"""Cheap seeds of the control variate."""

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


def judged(table: Table, scene: str, policy: str) -> Iterator[dict[str, object]]:
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
) -> dict[str, object]:
    """Errors in percent; shares of estimates that are close, over all x and at the worst x."""
    row: dict[str, object] = {"scene": scene, "policy": policy, "rung": rung}
    row["cost"] = round(cost, 3)
    for number, measure in enumerate(("time", "messages")):
        row[f"{measure}_worst"] = round(100 * float(rms[number].max()), 2)
        row[f"{measure}_median"] = round(100 * float(np.median(rms[number])), 2)
        row[f"{measure}_close"] = round(float(within[number].mean()), 3)
        row[f"{measure}_close_worst"] = round(float(within[number].min()), 3)
    row["covered"] = "" if covered is None else round(float(covered), 3)
    return row


def draw(rows: list[dict[str, object]]) -> None:
    """The worst point of each scene of figure 4, concurrent dataflow; full runs are the line."""
    figure = Figure(figsize=(9, 5.6), layout="constrained")
    colours = dict(zip(FIGURE4, ("#0072b2", "#d55e00", "#009e73", "#000000"), strict=True))
    chosen = [row for row in rows if row["scene"] in FIGURE4 and row["policy"] == "concurrent"]
    names = list(dict.fromkeys(row["rung"] for row in chosen if "full x" not in str(row["rung"])))
    letters = dict(zip(names, (f"${letter}$" for letter in "ABCDEFGHIJKLM"), strict=False))
    for axes, measure in zip(figure.subplots(1, 2, sharey=True), ("time", "messages"), strict=True):
        for scene, colour in colours.items():
            of_scene = [row for row in chosen if row["scene"] == scene]
            full = [row for row in of_scene if "full x" in str(row["rung"])]
            xs, ys = ([row[key] for row in full] for key in ("cost", f"{measure}_worst"))
            axes.plot(xs, ys, color=colour, linewidth=0.8, marker="o", markersize=3)
            for row in of_scene:
                if row not in full:
                    place = (row["cost"], max(float(row[f"{measure}_worst"]), 0.1))
                    axes.scatter(
                        *place, 40, color=colour, marker=letters[row["rung"]], linewidth=0.4
                    )
        axes.axhline(100 * CLOSE / 1.96, color="black", linewidth=0.8, linestyle="dotted")
        axes.set(xscale="log", yscale="log", xlabel="CPU time / one full seed of the curve")
        axes.set_title({"time": "time profit", "messages": "message profit"}[measure], fontsize=9)
        axes.set_xticks([0.1, 0.2, 0.5, 1, 2, 4, 8], ["0.1", "0.2", "0.5", "1", "2", "4", "8"])
        axes.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
        axes.minorticks_off()
    figure.axes[0].set_ylabel("root mean square error at the worst x, %")
    last = figure.axes[1]
    marks = [
        last.scatter([], [], 40, color="black", marker=letters[name], linewidth=0.4, label=name)
        for name in names
    ]
    marks += [
        last.plot(
            [], [], color=colour, marker="o", markersize=3, label=f"{scene}: full x 1, 2, 4, 8"
        )[0]
        for scene, colour in colours.items()
    ]
    figure.legend(handles=marks, fontsize=7, loc="outside lower center", ncols=4)
    with matplotlib.rc_context({"svg.hashsalt": "simmpp", "svg.fonttype": "none"}):
        figure.savefig(HERE / "rungs.png", dpi=200)
        figure.savefig(HERE / "rungs.svg", metadata={"Date": None})


def main() -> None:
    """Simulate what is missing, judge, draw."""
    runs, rows = all_runs(), []
    for policy in ("concurrent", "ray"):
        for scene in (*FIGURE4, *HELD_OUT):
            rows += judged(table_of(runs, scene, policy), scene, policy)
    write_csv(rows, list(rows[0]), HERE / "rungs.csv")
    draw(rows)


if __name__ == "__main__":
    main()
