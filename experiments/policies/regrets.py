"""Which policy is never far from the best?

    python experiments/policies/regrets.py [FOLDER]

Reads regrets-points.csv and larger-points.csv; what is not there is simulated as the YAML of that
name says (finished simulations are kept in FOLDER, out/policies/regrets) and written. Writes the
tables of regrets, what was expected of them, and the figure.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from points import BOUND, EXPECTED, HERE, POINT, makespans, mean, of_scenes, write_outcomes

from simmpp.common.files import Row, write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save

NAME, LARGER = "regrets", "larger"
BUILT_IN = ["object", "object packed", "ray", "concurrent", "holders", "cost"]
CANDIDATE = "thrifty"
POLICIES = [*BUILT_IN, CANDIDATE]
"""Whose least makespan at a point is what regrets are measured against."""
ORACLES = ["concurrent exact", "holders exact", "holders two"]
MORE_RESIDENTS = "ray, 2 x"
"""Ray dataflow with as many more residents as it has room for fetched objects, which it has not."""
NEAR, FAR = 1.05, 1.25
HALVES = {"developed on": EXPECTED["developed_on"], "judged on": EXPECTED["judged_on"]}
RAYS_WIN = ["tetra:5", "tetra:6", "bunny.ply:100"]


def regrets(table: pd.DataFrame) -> pd.DataFrame:
    """Of all policies and what else they are compared with, over the best of the policies."""
    others = table[[*POLICIES, *ORACLES]].assign(**{MORE_RESIDENTS: ray_at_twice_x(table)})
    return others.div(table[POLICIES].min(axis=1), axis=0)


def summary(table: pd.DataFrame) -> Iterator[Row]:
    """How near each policy is to the best: of each half, and of each scene, PEs and residents."""
    of_all, over_bound = regrets(table), table[POLICIES].min(axis=1) / table[BOUND]
    parts = [(half, of_scenes(of_all, scenes)) for half, scenes in HALVES.items()]
    for level in POINT:
        parts += [(f"{level} {name}", part) for name, part in of_all.groupby(level)]
    parts = [(name, part.dropna(axis=1, how="all")) for name, part in parts]
    for name, part in parts:
        for policy in part:
            ratios = part[policy].dropna()
            yield {
                "points": name,
                "policy": policy,
                "n": len(ratios),
                "near": round(float((ratios <= NEAR).mean()), 3),
                "not_far": round(float((ratios <= FAR).mean()), 3),
                "mean_regret": round(mean(ratios), 3),
                "worst_regret": round(ratios.max(), 2),
                "over_bound": round(mean(ratios * over_bound[ratios.index]), 2),
            }


def found(table: pd.DataFrame) -> dict[str, float]:
    """The quantities that something was expected of."""
    built_in = table[BUILT_IN]
    best, which = built_in.min(axis=1), built_in.idxmin(axis=1)
    near = (built_in.div(best, axis=0) <= NEAR).mean()
    by_ray = which.index.get_level_values("scene").isin(RAYS_WIN)
    of_all, judged = regrets(table), regrets(of_scenes(table, HALVES["judged on"]))
    by_residents = {name: best.xs(name, level="residents") for name in ("random", "hot", "used")}
    over_bound = (best / table[BOUND]).groupby("processors").apply(mean)
    least = mean(judged[CANDIDATE]) <= min(mean(judged[policy]) for policy in BUILT_IN)
    return {
        "best built-in within 5 % (share of points)": float(near.max()),
        "worst regret of concurrent": float(of_all["concurrent"].max()),
        "ray is the best built-in on the tetrahedra and the mesh (share of points)": float(
            (which[by_ray] == "ray").mean()
        ),
        "ray is the best built-in elsewhere (share of points)": float(
            (which[~by_ray] == "ray").mean()
        ),
        "object (packed or not) is the best built-in (share of points)": float(
            which.isin(["object", "object packed"]).mean()
        ),
        "best with used / best with random residents": mean(
            by_residents["used"] / by_residents["random"]
        ),
        "best with hot / best with random residents": mean(
            by_residents["hot"] / by_residents["random"]
        ),
        "best / bound at 8 PEs": float(over_bound[8]),
        "best / bound at 64 PEs": float(over_bound[64]),
        "ray at twice x / ray": mean((ray_at_twice_x(table) / table["ray"]).dropna()),
        "holders / concurrent": mean(table["holders"] / table["concurrent"]),
        "candidate within 5 % (share of points judged on)": float(
            (judged[CANDIDATE] <= NEAR).mean()
        ),
        "worst regret of the candidate on points judged on": float(judged[CANDIDATE].max()),
        "candidate's mean regret is the least of all policies (1 yes)": float(least),
    }


def ray_at_twice_x(table: pd.DataFrame) -> pd.Series:
    """Ray dataflow with the room that it has no fetched objects for; missing at the largest x."""
    at = table["ray"].reset_index()
    return at.assign(fraction=at["fraction"] / 2).set_index(table.index.names)["ray"]


def draw(table: pd.DataFrame) -> None:
    """Share of the points where a policy is at most so far from the best, for each half."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(10, 4.8), layout="constrained")
        for axes, (half, scenes) in zip(
            figure.subplots(1, 2, sharey=True), HALVES.items(), strict=True
        ):
            of_half = regrets(of_scenes(table, scenes))
            draw_half(axes, of_half)
            axes.set_title(f"scenes {half} ({len(of_half)} points)", fontsize=9)
        figure.axes[0].set_ylabel("share of the points (%)")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(POLICIES))
        save(figure, HERE / NAME)


def draw_half(axes: Axes, of_half: pd.DataFrame) -> None:
    """A step for each point; performance profiles after Dolan and More (2002)."""
    shares = [100 * (i + 1) / len(of_half) for i in range(len(of_half))]
    for policy, style in zip(POLICIES, STYLES, strict=True):
        width = 2.2 if policy == CANDIDATE else 1.2
        line = {"color": style["color"], "linestyle": style["linestyle"], "linewidth": width}
        axes.step(sorted(of_half[policy]), shares, where="post", label=policy, **line)
    axes.axvspan(1, NEAR, color="0.88", zorder=0)
    axes.axvline(FAR, color="0.5", linewidth=0.8)
    axes.axhline(90, color="0.5", linewidth=0.8)
    axes.set_xscale("log")
    ticks = (NEAR, FAR, 1.5, 2, 3, 5, 10)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks], fontsize=8)
    axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_xlim(1, 10)
    axes.set_ylim(0, 101)
    axes.set_xlabel("makespan / the best policy's at the point")
    axes.grid(linewidth=0.3, color="0.8")


def main() -> None:
    """Simulate what isn't there; write the table of regrets, outcomes and figure."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else f"out/policies/{NAME}")
    table = makespans(NAME, folder)
    rows = list(summary(table))
    write_csv(rows, list(rows[0]), HERE / f"{NAME}-summary.csv")
    for row in rows[: 2 * len(regrets(table).columns)]:
        print(*row.values(), sep="\t")
    write_outcomes(found(table), NAME)
    draw(table)
    larger = [row for row in summary(makespans(LARGER, folder / LARGER)) if row["points"] in HALVES]
    write_csv(larger, list(larger[0]), HERE / f"{LARGER}-summary.csv")


if __name__ == "__main__":
    main()
