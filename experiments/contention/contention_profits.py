"""Does waiting for links make profits fall where each PE owns less than a tenth of the scene?

    simmpp sweep experiments/contention/contention_profits.yaml --out DIR
    simmpp sweep experiments/contention/contention_slower.yaml --out SLOWER
    python experiments/contention/contention_profits.py DIR SLOWER

Nebel 1998, section 4.2.2, sees the time profit of concurrent dataflow decrease there and supposes
that "some messages cause wait states". Writes contention_profits.csv, a row per scene, bandwidth of
links, contention and x with the profits of concurrent over object dataflow and what the time profit
is of the one at x = 10 % (means over seeds and 95 % t-intervals, seed by seed), and draws it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from simmpp.machine.torus import CONTENTIONS, LINKS, NO_CONTENTION
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.plot.matplotlib_panels import draw
from simmpp.studies.nebel98.figures import NAMES

HERE = Path(__file__).parent
KEYS = ["scene", "machine.link_bandwidth", "machine.contention", "fraction"]
TENTH = 0.1
DRAWN = {"480 MB/s": "links of the T3E, 480 MB/s", "5 MB/s": "links of 5 MB/s"}
PERCENT = 100


def profits_of(results: pd.DataFrame) -> pd.DataFrame:
    """A row per point and seed: what object dataflow needs over what concurrent dataflow needs."""
    by_policy = results.pivot(
        index=[*KEYS, "seed"], columns="policy", values=["makespan_ps", "messages"]
    )
    rows = pd.DataFrame(index=by_policy.index)
    for column, name in (("makespan_ps", "time_profit"), ("messages", "message_profit")):
        rows[name] = by_policy[column]["object"] / by_policy[column]["concurrent"]
    for policy in ("object", "concurrent"):
        rows[f"{policy}_ms"] = by_policy["makespan_ps"][policy] / 10**9
    tenth = rows["time_profit"].xs(TENTH, level="fraction")
    places = rows.reset_index("fraction").index
    return rows.assign(of_tenth=rows["time_profit"] / tenth.reindex(places).to_numpy())


def summary(rows: pd.DataFrame) -> pd.DataFrame:
    """Means over seeds, and the intervals of what is judged."""
    groups = rows.groupby(level=KEYS, sort=False)
    found = groups.mean()
    n = groups.size()
    for name in ("time_profit", "of_tenth"):
        half = stats.t.ppf(0.975, n - 1) * groups[name].std() / np.sqrt(n)
        found[f"{name}_low"], found[f"{name}_high"] = found[name] - half, found[name] + half
    return found.assign(n=n).reset_index()


def panels(table: pd.DataFrame) -> list[Panel]:
    """Time profits with contention over those without, which are grey."""
    x = Scale("objects resident on each PE (% of the scene)", is_log=True, ticks=(1.6, 3, 10, 30))
    found = []
    for bandwidth, title in DRAWN.items():
        here = table[table["machine.link_bandwidth"] == bandwidth]
        curves: list[Curve] = []
        for scene, name in NAMES.items():
            for contention in CONTENTIONS:
                rows = here[(here["scene"] == scene) & (here["machine.contention"] == contention)]
                points = {
                    round(row["fraction"] * PERCENT, 1): Spread(
                        row["time_profit"], row["time_profit_low"], row["time_profit_high"]
                    )
                    for _, row in rows.iterrows()
                }
                free = contention == NO_CONTENTION
                label = "_" if free and curves else "without contention" if free else name
                curves += [Curve(label, points, is_guide=free)] if points else []
        note = "means of 4 seeds, and their 95 % intervals"
        profit = Scale("time profit of concurrent over object dataflow")
        found.append(Panel(f"Contention, {title}", x, profit, curves, level=1, note=note))
    return found


def main(folders: list[Path]) -> None:
    """Make the table and the figure of the rows of both sweeps."""
    rows = pd.concat([pd.read_csv(folder / "results.csv") for folder in folders])
    table = summary(profits_of(rows.fillna({"machine.contention": LINKS})))
    table.to_csv(HERE / "contention_profits.csv", index=False, float_format="%.5g")
    draw(panels(table), HERE / "contention_profits")


if __name__ == "__main__":
    main([Path(folder) for folder in sys.argv[1:]])
