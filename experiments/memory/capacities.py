"""How much memory does each policy need, and what does less of it cost?

    python experiments/memory/capacities.py [FOLDER]

Reads capacities-points.csv; if it is not there, it is simulated as capacities.yaml says (finished
simulations are kept in FOLDER, out/memory/capacities) and written. Writes what was expected beside
what came out, the summary by capacity, knees and the figure.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
from bounded import CAPACITY, HERE, LEAST, MS, UNBOUNDED, in_bytes, mean, points, write_outcomes
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from simmpp.common.files import Row, write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save
from simmpp.studies.nebel98.figures import NAMES
from simmpp.sweeps.winners.knee import LONGER

NAME = "capacities"
PLACE = ["scene", "processors", "reading"]
KEYS = [*PLACE, "policy", CAPACITY]
FLOWS = ["object", "ray", "concurrent"]
POLICIES = [*FLOWS, "replicated"]
WITH = " stealing"
"""What labels of policies with stealing end with."""
SCENES = ["mountain:5", "rings:1", "tetra:5", "tetra:6"]
TETRAHEDRA = SCENES[2:]
RAY_BYTES, PIXELS, DRAWN_PES = 128, 96 * 96, 64
TREES = {"mountain:5": 19, "rings:1": 12, "tetra:5": 1, "tetra:6": 1}
"""Rays that can be alive at once of one pixel's, as the least capacities have it."""
QUEUE = 0.75
"""Of the room that permanent parts leave, what is for the rays of a policy that sends none."""
KEPT = "concurrent: time profit at least 0.95 of that with unbounded memory (share of capacities)"
FASTEST = "concurrent is the fastest of three at the least capacity that fits all (share of points)"
MULTIPLES = (1, 1.5, 2, 4, 8)


class Curves:
    """Makespans over capacity of all policies and places."""

    def __init__(self, table: pd.DataFrame) -> None:
        flat = table.reset_index()
        flat["bytes"] = [in_bytes(cell) for cell in flat[CAPACITY]]
        flat["with_least"] = flat["bytes"].where(flat[CAPACITY] != LEAST, flat["least_bytes"])
        self.table = flat
        there = set(flat["policy"])
        self.policies = [p for p in (*POLICIES, *(q + WITH for q in POLICIES)) if p in there]
        unbounded = flat[flat[CAPACITY] == UNBOUNDED].set_index([*PLACE, "policy"])
        places = pd.MultiIndex.from_frame(flat[[*PLACE, "policy"]])
        flat["slowdown"] = flat[MS] / unbounded[MS].reindex(places).to_numpy()
        flat["more_messages"] = flat["messages"] / unbounded["messages"].reindex(places).to_numpy()
        self.unbounded = unbounded[MS].unstack("policy")

    def of(self, policy: str, **places: object) -> pd.DataFrame:
        """The rows of a policy at some places."""
        rows = self.table[self.table["policy"] == policy]
        for key, value in places.items():
            wanted = value if isinstance(value, list) else [value]
            rows = rows[rows[key].isin(wanted)]
        return rows

    def at_least(self, policy: str, **places: object) -> pd.DataFrame:
        """Its rows at its least capacity."""
        rows = self.of(policy, **places)
        return rows[rows[CAPACITY] == LEAST]

    def at_multiple(self, policy: str, times: float, **places: object) -> pd.Series:
        """Slowdowns at the smallest capacity of the grid that is so many times its least."""
        rows = self.of(policy, **places)
        rows = rows[rows["bytes"] >= times * rows["least_bytes"]].sort_values("bytes")
        return rows.groupby(PLACE)["slowdown"].first()

    def knee(self, policy: str, most: float) -> pd.DataFrame:
        """Per place the smallest capacity of the grid with at most that slowdown."""
        rows = self.of(policy)
        rows = rows[(rows["slowdown"] <= most) & rows["bytes"].notna()].sort_values("bytes")
        return rows.groupby(PLACE)[["bytes", "least_bytes"]].first()

    @property
    def of_flows(self) -> pd.DataFrame:
        """Makespans of the dataflows (columns) where all fit, by place and bytes."""
        rows = self.table[self.table["policy"].isin(FLOWS) & self.table["bytes"].notna()]
        wide = rows.pivot_table(index=[*PLACE, "bytes"], columns="policy", values=MS)
        return wide[FLOWS].dropna()


def found(curves: Curves) -> dict[str, float]:
    """The quantities that something was expected of."""
    least = {policy: curves.at_least(policy) for policy in POLICIES}
    mountain = {"scene": "mountain:5"}
    fits_all = curves.of_flows.groupby(PLACE).first().idxmin(axis=1)
    return {
        "object: slowdown at the least": mean(least["object"]["slowdown"]),
        "object: messages at the least over those with unbounded memory": mean(
            least["object"]["more_messages"]
        ),
        "object: slope of log makespan over log room, where the slowdown is above 2": slope(curves),
        "object: rays that there is room for at the knee of 1.05, per primary ray of a PE": mean(
            window_of_knee(curves)
        ),
        "ray on mountain:5: slowdown at twice the least": mean(
            curves.at_multiple("ray", 2, **mountain)
        ),
        "ray on mountain:5: slowdown at the least": mean(
            curves.at_least("ray", **mountain)["slowdown"]
        ),
        "ray on the tetrahedra: slowdown at the least": mean(
            curves.at_least("ray", scene=TETRAHEDRA)["slowdown"]
        ),
        "ray: escapes per test at the least": mean(least["ray"]["escapes"] / least["ray"]["tests"]),
        "concurrent: slowdown at twice the least": mean(curves.at_multiple("concurrent", 2)),
        KEPT: profits_kept(curves),
        "concurrent: slowdown at the least": mean(least["concurrent"]["slowdown"]),
        "replicated: slowdown at the least": mean(least["replicated"]["slowdown"]),
        FASTEST: float((fits_all == "concurrent").mean()),
        "object is the fastest of three there (share of points)": float(
            (fits_all == "object").mean()
        ),
        "fastest of three over replicated where the scene just fits": mean(where_it_fits(curves)),
        "the same of three wins as with unbounded memory (share of capacities that fit all)": (
            same_winner(curves)
        ),
    } | of_stealing(curves)


def slope(curves: Curves) -> float:
    """Of object dataflow's makespan over what permanent parts leave, within each place."""
    rows = curves.of("object")
    rows = rows[rows["with_least"].notna() & (rows["slowdown"] > 2)]
    x, y = np.log(rows["with_least"] - rows["least_bytes"] + tree_bytes(rows)), np.log(rows[MS])
    places = pd.MultiIndex.from_frame(rows[PLACE])
    x, y = (pd.Series(v.to_numpy(), index=places) for v in (x, y))
    x, y = (v - v.groupby(PLACE).transform("mean") for v in (x, y))
    return float((x * y).sum() / (x * x).sum())


def tree_bytes(rows: pd.DataFrame) -> np.ndarray:
    """Of the rays of the largest tree of each row's scene."""
    return rows["scene"].map(TREES).to_numpy() * RAY_BYTES


def window_of_knee(curves: Curves) -> pd.Series:
    """Rays that object dataflow has room for at its first knee, per primary ray of a PE."""
    knee = curves.knee("object", LONGER[0]).reset_index()
    room = QUEUE * (knee["bytes"] - knee["least_bytes"] + tree_bytes(knee))
    return room / RAY_BYTES / (PIXELS / knee["processors"])


def profits_kept(curves: Curves) -> float:
    """Share of capacities that fit all dataflows with nearly the profit of unbounded memory."""
    wide = curves.of_flows
    profit = wide["object"] / wide["concurrent"]
    of_all = curves.unbounded["object"] / curves.unbounded["concurrent"]
    places = wide.reset_index("bytes").index
    return float((profit.to_numpy() >= 0.95 * of_all.reindex(places).to_numpy()).mean())


def where_it_fits(curves: Curves) -> pd.Series:
    """The fastest dataflow over the replicated scene at the least capacity that has it."""
    rows = curves.of("replicated")
    rows = rows[rows["bytes"].notna()].sort_values("bytes").groupby(PLACE).first().reset_index()
    ceiling = rows.set_index([*PLACE, "bytes"])[MS]
    return (curves.of_flows.min(axis=1) / ceiling).dropna()


def same_winner(curves: Curves) -> float:
    """Share of the capacities at which the dataflow wins that does with unbounded memory."""
    wide = curves.of_flows
    winner = curves.unbounded[FLOWS].idxmin(axis=1).reindex(wide.reset_index("bytes").index)
    return float((wide.idxmin(axis=1).to_numpy() == winner.to_numpy()).mean())


def of_stealing(curves: Curves) -> dict[str, float]:
    """Makespans with stealing over those without, with unbounded memory."""
    if not any(name.endswith(WITH) for name in curves.policies):
        return {}
    table = curves.unbounded
    gain = {name: table[name + WITH] / table[name] for name in POLICIES}
    plain = {name: of.xs("plain", level="reading") for name, of in gain.items()}
    return {
        "replicated: with stealing over without, plain": mean(plain["replicated"]),
        "replicated: with stealing over without, mixed": mean(
            gain["replicated"].xs("mixed", level="reading")
        ),
        "object: with stealing over without, plain": mean(plain["object"]),
        "concurrent: with stealing over without": mean(gain["concurrent"]),
        "ray: with stealing over without": mean(gain["ray"]),
        "object with stealing over concurrent without": mean(
            table["object" + WITH] / table["concurrent"]
        ),
    }


def summary(curves: Curves) -> Iterator[Row]:
    """Slowdowns of each policy by multiples of its least, and knees over the least."""
    parts: dict[str, dict[str, object]] = {"all": {}}
    parts |= {f"{p} PEs": {"processors": p} for p in (8, 24, 64)}
    parts |= {reading: {"reading": reading} for reading in ("plain", "mixed")}
    parts |= {scene: {"scene": scene} for scene in SCENES}
    for part, places in parts.items():
        for policy in curves.policies:
            at_least = curves.at_least(policy, **places)
            row: Row = {"points": part, "policy": policy, "n": len(at_least)}
            row["at the least"] = mean(at_least["slowdown"])
            for times in MULTIPLES[1:]:
                row[f"at {times:g} x"] = mean(curves.at_multiple(policy, times, **places))
            row["messages at the least"] = mean(at_least["more_messages"])
            row["escapes per test"] = float((at_least["escapes"] / at_least["tests"]).mean())
            yield {key: round(v, 3) if isinstance(v, float) else v for key, v in row.items()}


def knees(curves: Curves) -> Iterator[Row]:
    """For each policy and place the least capacity, and from where on it is nearly as fast."""
    for policy in curves.policies:
        table = curves.at_least(policy).set_index(PLACE)[["least_bytes"]].assign(policy=policy)
        for longer in LONGER:
            table[f"knee_bytes_{longer:g}"] = curves.knee(policy, longer)["bytes"]
        for row in table.reset_index().to_dict("records"):
            cells = {str(name): cell for name, cell in row.items()}
            yield {k: of if isinstance(of, str) else whole(of) for k, of in cells.items()}


def whole(size: float) -> int | str:
    """Without decimals; nothing where it is not known."""
    return "" if np.isnan(size) else int(size)


def draw(curves: Curves) -> None:
    """Makespan over capacity on 64 PEs: a panel for each scene and reading."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(12, 5.6), layout="constrained")
        grid = figure.subplots(2, 4, sharex=True)
        for row, reading in zip(grid, ("plain", "mixed"), strict=True):
            for axes, scene in zip(row, SCENES, strict=True):
                draw_panel(axes, curves, scene=scene, reading=reading, processors=DRAWN_PES)
                axes.set_title(f"{NAMES[scene]}, {reading}", fontsize=9)
            row[0].set_ylabel("makespan (ms)")
        for axes in grid[1]:
            axes.set_xlabel("memory of a PE (kB)")
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
        save(figure, HERE / NAME)


def draw_panel(axes: Axes, curves: Curves, **place: object) -> None:
    """A curve for each policy from its least on; dotted: unbounded memory."""
    for policy in curves.policies:
        style = dict(STYLES[POLICIES.index(policy.removesuffix(WITH))])
        if policy.endswith(WITH):
            style |= {"linestyle": (0, (1, 1)), "marker": "None"}
        rows = curves.of(policy, **place)
        rows = rows[rows["with_least"].notna()].sort_values("with_least")
        axes.plot(rows["with_least"] / 1e3, rows[MS], label=policy, **style | {"markersize": 3})
    axes.set(xscale="log", yscale="log")
    axes.grid(linewidth=0.3, color="0.8")


def main() -> None:
    """Simulate what isn't there; write tables and figure."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else f"out/memory/{NAME}")
    curves = Curves(points(NAME, KEYS, folder))
    for name, rows in ((f"{NAME}-summary", summary(curves)), ("knees", knees(curves))):
        told = list(rows)
        write_csv(told, list(told[0]), HERE / f"{name}.csv")
    write_outcomes(found(curves), NAME)
    draw(curves)


if __name__ == "__main__":
    main()
