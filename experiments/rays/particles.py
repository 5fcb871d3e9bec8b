"""Dataflows on particles through cells: judges what was expected, and draws.

    python experiments/rays/particles.py

Sweeps particles.yaml unless its rows (particles.csv) are there, writes particles-expected.csv (each
expectation of README.md and what came out), particles.png, and hohlraum.png, a map of the tracks.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pandas as pd
from matplotlib.figure import Figure

import simmpp
from simmpp.common.files import write_csv
from simmpp.config.config import load_config
from simmpp.plot.matplotlib_panels import SETTINGS, save
from simmpp.workload.trace.shading import save_png

HERE = Path(__file__).parent
SCENES, WAYS, KEPT = ("hohlraum", "cube"), ("home", "interleaved"), ("0", "x")
POLICIES = ("object", "ray", "concurrent")
NAMES = {"object": "cell passing", "ray": "particle passing", "concurrent": "concurrent"}
BELOW = (0.02, 0.1, 0.25)
COLOURS = {"object": "#d55e00", "ray": "#0072b2", "concurrent": "#009e73"}
KEYS = ["scene", "fraction", "memory.transient", "placement.pixels", "policy"]
MEASURES = ["makespan_ps", "messages", "compute_ps", "objects_fetched", "tests"]
PROCESSORS, FINE, MANY = 64, 4, 2_000_000
Case = tuple[str, float, str, str]
"""Cells, x, what is kept, where particles start."""
Expected = tuple[str, bool, str]


def rows() -> pd.DataFrame:
    """Means over seeds of each place and policy, from the file or simulated."""
    file = HERE / "particles.csv"
    if not file.exists():
        found, _ = simmpp.sweep(HERE / "particles.yaml")
        means = found.groupby(KEYS, as_index=False, sort=True)[MEASURES].mean()
        means[MEASURES] = means[MEASURES].round().astype("int64")
        means.to_csv(file, index=False)
    return pd.read_csv(file, dtype={"memory.transient": str})


class Rows:
    """Asked by what they are of."""

    def __init__(self) -> None:
        self._rows = rows().set_index(["scene", "fraction", *KEYS[2:]])

    def of(self, column: str, policy: str, case: Case) -> float:
        return float(self._rows.loc[(*case, policy), column])  # type: ignore[arg-type]

    def profit(self, policy: str, case: Case, column: str = "makespan_ps") -> float:
        return self.of(column, "object", case) / max(1.0, self.of(column, policy, case))

    def efficiency(self, policy: str, case: Case) -> float:
        spent = self.of("makespan_ps", policy, case) * PROCESSORS
        return self.of("compute_ps", policy, case) / spent

    def best(self, case: Case) -> str:
        return max(POLICIES, key=lambda policy: self.profit(policy, case))


def cases(xs: tuple[float, ...] = (*BELOW, 0.5)) -> list[Case]:
    return [(s, x, k, w) for s in SCENES for x in xs for k in KEPT for w in WAYS]


def of_hohlraum(rows: Rows) -> Iterator[Expected]:
    """Which, whether it came out, and in numbers."""
    home = [(x, k, ("hohlraum", x, k, "home")) for x in (*BELOW, 0.5) for k in KEPT]
    most = max(rows.efficiency("object", case) for _, _, case in home)
    yield "H1", most < 0.15, f"at most {most:.1%}"
    ratios = [
        rows.of("makespan_ps", "ray", case) / rows.of("makespan_ps", "replicated", case)
        for x, _, case in home
        if x < 0.5
    ]
    told = f"{min(ratios):.2f} to {max(ratios):.2f} of the time of replication"
    yield "H2", max(ratios) < 1, told
    at_home, dealt = (rows.profit("ray", ("hohlraum", 0.1, "0", way)) for way in WAYS)
    yield "H3", dealt < at_home / 5, f"{dealt:.2f} dealt, {at_home:.2f} from home"
    best = {x: rows.best(("hohlraum", x, "0", "interleaved")) for x in BELOW}
    told = ", ".join(f"{x:.0%}: {policy}" for x, policy in best.items())
    yield "H4", set(best.values()) == {"concurrent"}, told


def of_cube(rows: Rows) -> Iterator[Expected]:
    """Likewise."""
    home: Case = ("cube", 0.1, "0", "home")
    ratios = [
        rows.of("makespan_ps", "ray", ("cube", 0.1, kept, "home"))
        / rows.of("makespan_ps", "replicated", ("cube", 0.1, kept, "home"))
        for kept in KEPT
    ]
    yield "C1", max(ratios) <= 1.5, f"{max(ratios):.2f} times the time of replication"
    profit = rows.profit("ray", home)
    yield "C2", 2 <= profit <= 10, f"{profit:.2f}"
    best = {x: rows.best(("cube", x, "0", "interleaved")) for x in BELOW}
    told = ", ".join(f"{x:.0%}: {policy}" for x, policy in best.items())
    yield "C3", set(best.values()) == {"ray"}, told
    case: Case = ("cube", 0.02, "0", "interleaved")
    share = rows.of("objects_fetched", "object", case) / rows.of("tests", "object", case)
    yield "C4", share < 0.2, f"{share:.3f} cells fetched a test"


def of_both(rows: Rows) -> Iterator[Expected]:
    """Likewise."""
    gains = {case: rows.profit("concurrent", case) for case in cases()}
    least = min(gains, key=lambda case: gains[case])
    yield "P2", gains[least] >= 1, f"least {gains[least]:.2f}: {least}"
    shares = {
        case: rows.profit("concurrent", case) / max(1.0, rows.profit("ray", case))
        for case in cases(BELOW)
    }
    worst = min(shares, key=lambda case: shares[case])
    yield "P3", shares[worst] >= 0.8, f"least {shares[worst]:.2f}: {worst}"
    fewer = [rows.profit("ray", case, "messages") for case in cases(BELOW)]
    yield "P4", min(fewer) > 1, f"{min(fewer):.2f} to {max(fewer):.1f}"


def draw(rows: Rows) -> None:
    """Time profits over x."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(9, 5), layout="constrained")
        axes = figure.subplots(2, 4, sharex=True, sharey="row")
        xs = (*BELOW, 0.5)
        columns = [(way, kept) for way in WAYS for kept in KEPT]
        for of_scene, scene in zip(axes, SCENES, strict=True):
            for axis, (way, kept) in zip(of_scene, columns, strict=True):
                for policy in POLICIES:
                    ys = [rows.profit(policy, (scene, x, kept, way)) for x in xs]
                    color = COLOURS[policy]
                    axis.plot(xs, ys, marker="o", ms=3, color=color, label=NAMES[policy])
                axis.set_xscale("log")
                axis.set_yscale("log")
                axis.set_xticks(xs, [f"{100 * x:.0f} %" for x in xs])
                axis.minorticks_off()
                start = "from home" if way == "home" else "dealt"
                axis.set_title(f"{scene}, {start}{', x kept' if kept == 'x' else ''}", fontsize=8)
        for axis, ticks in zip(axes[:, 0], ((1, 2, 5, 10), (1, 2, 3)), strict=True):
            axis.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
            axis.set_ylim(bottom=0.9)
        axes[0, 3].legend(fontsize=7)
        figure.supxlabel("share x of the cells on each PE", fontsize=9)
        figure.supylabel("time profit over cell passing", fontsize=9)
        save(figure, HERE / "particles")


def map_of_tracks() -> None:
    """The hohlraum with Branson's cells, nearly, and many particles."""
    over = [f"scene=hohlraum:{FINE}", f"particles.count={MANY}", "sweep={}"]
    config = load_config(HERE / "particles.yaml", over)
    source = config.ray_source
    workload = source.workload(config.picture, None, None)
    save_png(source.draw(config.picture, workload), HERE / "hohlraum.png")


def main() -> None:
    """Simulate unless it was, judge, draw."""
    table = Rows()
    judged = [
        {"expectation": name, "came_out": "yes" if did else "no", "found": found}
        for part in (of_hohlraum(table), of_cube(table), of_both(table))
        for name, did, found in part
    ]
    for line in judged:
        print(line)
    write_csv(judged, list(judged[0]), HERE / "particles-expected.csv")
    draw(table)
    if not (HERE / "hohlraum.png").exists():
        map_of_tracks()


if __name__ == "__main__":
    main()
