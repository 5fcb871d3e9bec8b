"""The experiments of Nebel 1998 from configuration to verdict, on pictures of 16 x 16 pixels."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.config.config import load_config
from simmpp.config.settings import DEFAULT_READING
from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.figures import FIGURES, PERCENT
from simmpp.studies.nebel98.reproduce import (
    EXPERIMENTS,
    MODEL,
    Reproduction,
    configuration,
    reproduce,
)
from simmpp.studies.nebel98.verdict import Verdict
from simmpp.sweeps.journal import FILE, Outcome
from simmpp.sweeps.profits import profit_rows
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import Watcher

PUBLISHED = Path(__file__).parents[2] / "experiments" / "nebel98"
READINGS = ("plain", "mixed", "S1")
CLAIMS = ["F2a", "F2b", "F3a", "F3b", "F3c", "F4a", "F4b", "F4c", "F4d", "F5a", "F6a", "T1", "T2"]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("nebel98")


@pytest.fixture(scope="module")
def done(out: Path) -> Reproduction:
    (done,) = reproduce(out, seeds=1, resolution=16)
    return done


def rows_of(path: Path) -> list[Row]:
    with open(path, encoding="utf-8", newline="") as file:
        rows: list[Row] = list(csv.DictReader(file))
    for row in rows:
        for name, cell in row.items():
            if name in ("fraction", "effective_fraction"):
                row[name] = float(cell)
            elif cell.isdigit():
                row[name] = int(cell)
    return rows


def test_each_claim_has_its_verdict(done: Reproduction, out: Path) -> None:
    assert not done.failed
    with open(out / "claims.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["claim"] for row in table] == CLAIMS == [each.claim for each in done.verdicts]
    assert {row["holds"] for row in table} <= {"holds", "in part", "does not"}
    assert all(row["paper"] and row["simulated"] and row["by"] for row in table)


def test_each_figure_is_written_twice_beside_its_rows(done: Reproduction, out: Path) -> None:
    for figure in (*FIGURES, MODEL):
        assert (out / f"{figure}.png").read_bytes().startswith(b"\x89PNG")
        assert "<svg" in (out / f"{figure}.svg").read_text(encoding="utf-8")
    for name in (*EXPERIMENTS, MODEL):
        assert (out / f"{name}.csv").stat().st_size
        first, _, rest = (out / f"{name}.yaml").read_text(encoding="utf-8").partition("\n")
        assert first == "# Run with --set 'seeds=[0]' --set 'picture.resolution=16'"
        assert rest == configuration(name)


def test_equal_points_of_all_figures_are_simulated_once(done: Reproduction, out: Path) -> None:
    rows = {
        tuple(row[name] for name in ("scene", "processors", "fraction", "policy", "seed"))
        for name in EXPERIMENTS
        for row in rows_of(out / f"{name}.csv")
        if row["policy"] != "replicated" and row["fraction"] < 1
    }
    simulated = [
        line for line in (out / "points.jsonl").read_text().splitlines() if '"numbers"' in line
    ]
    everything = {("mountain:5", nb) for nb in (32, 64, 128, 256, 512, 1024)}
    everything |= {("tetra:5", nb) for nb in (8, 16, 32, 64, 128)}
    everything |= {(scene, 64) for scene in ("rings:1", "rings:7", "tetra:6")}
    assert len(simulated) == len(rows) + len(everything)  # whatever the policy


def test_figures_show_the_rows(done: Reproduction, out: Path) -> None:
    rows = rows_of(out / "figure4.csv")
    (panel,) = FIGURES["figure4"][1](RowIndex(rows))
    shown = {(each.label, x): each.points[x].mean for each in panel.curves for x in each.points}
    names = {"mountain:5": "Mountain5", "rings:1": "Ring1"}
    names |= {"tetra:5": "Tetrahedron5", "tetra:6": "Tetrahedron6"}
    assert shown == {
        (names[row["scene"]], PERCENT * row["fraction"]): row["time_profit"]
        for row in profit_rows(rows)
        if row["policy"] == "concurrent"
    }


class Idle(Watcher):
    def __init__(self) -> None:
        self.drawn: list[tuple[int, int]] = []

    def drawing(self, done: int, total: int) -> None:
        self.drawn.append((done, total))

    def simulated(self, outcome: Outcome) -> None:
        raise AssertionError(outcome)


def test_again_nothing_is_simulated_and_all_bytes_are_the_same(
    done: Reproduction, out: Path
) -> None:
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    idle = Idle()
    assert reproduce(out, seeds=1, resolution=16, watcher=idle) == [done]
    whole = len(FIGURES) + 1
    assert idle.drawn == [(figures, whole) for figures in range(whole + 1)]
    assert before == {path.name: path.read_bytes() for path in out.iterdir()}


def test_each_reading_has_its_folder_and_its_claims(
    done: Reproduction, out: Path, tmp_path: Path
) -> None:
    same = tmp_path / "same.yaml"
    same.write_text(f"description: the default under another name\nbased_on: {DEFAULT_READING}\n")
    of_default = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
    readings = [DEFAULT_READING, str(same)]
    of_both = reproduce(out, readings=readings, seeds=1, resolution=16, watcher=Idle())
    assert [one.reading for one in of_both] == [DEFAULT_READING, "same"]
    assert [one.verdicts for one in of_both] == [done.verdicts] * 2

    claims = (out / "claims.csv").read_text().splitlines()
    before = of_default["claims.csv"].decode().splitlines()
    assert claims[0] == f"reading,{before[0]}"
    assert claims[1:] == [f"{name},{ln}" for name in (DEFAULT_READING, "same") for ln in before[1:]]
    for name in (DEFAULT_READING, "same"):
        folder = out / name
        written = {path.name for path in folder.iterdir()}
        assert written == set(of_default) - {FILE}
        own = (folder / "claims.csv").read_text().splitlines()
        assert own == [claims[0], *(ln for ln in claims[1:] if ln.startswith(f"{name},"))]
        for figure in (*EXPERIMENTS, MODEL):
            assert (folder / f"{figure}.csv").read_bytes() == of_default[f"{figure}.csv"]
        said = (folder / "figure3.yaml").read_text().partition("\n")[0]
        assert said.endswith(f"--set 'reading={same if name == 'same' else name}'")
    for figure in (*FIGURES, MODEL):
        drawn = (out / DEFAULT_READING / f"{figure}.svg").read_bytes()
        assert drawn == of_default[f"{figure}.svg"]
    assert "reading same" in (out / "same" / "figure4.svg").read_text()


def test_two_readings_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="two readings are called 'plain'"):
        reproduce(tmp_path / "out", readings=["plain", "sub/plain.yaml"])
    with pytest.raises(ConfigError, match="two readings are called 'plain'"):
        reproduce(tmp_path / "out", readings=["sub/plain.yaml"])
    assert not (tmp_path / "out").exists()


def test_the_folder_of_a_reading_holds_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "plain").mkdir()
    (tmp_path / "plain" / "timings.csv").write_text("of a sweep")
    with pytest.raises(ConfigError, match=r"plain: holds the files of a sweep: expected those"):
        reproduce(tmp_path, readings=["mixed", "plain"], watcher=Idle())
    assert [path.name for path in (tmp_path / "plain").iterdir()] == ["timings.csv"]


@pytest.mark.parametrize("name", [*EXPERIMENTS, MODEL])
def test_experiments_have_eight_seeds_and_nothing_of_their_own(name: str, tmp_path: Path) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(configuration(name), encoding="utf-8")
    config = load_config(path)
    settings = config.settings
    assert name == MODEL or settings.seeds == tuple(range(8))
    assert config.kept_source.data.keys() <= {
        "scene", "picture", "machine", "processors", "policy", "seeds", "sweep", "method"
    }  # fmt: skip
    assert settings.machine.model_fields_set == {"preset"}
    assert all(policy == config.reading.policy(policy.name) for policy in settings.policy)


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name", [*EXPERIMENTS, MODEL])
def test_published_configurations_are_the_packages(reading: str, name: str) -> None:
    first, text = (PUBLISHED / reading / f"{name}.yaml").read_text("utf-8").split("\n", 1)
    assert first.startswith("# Run with --set 'reading=") and text == configuration(name)


@pytest.mark.parametrize("reading", READINGS)
def test_published_claims_follow_from_the_published_rows(reading: str) -> None:
    folder = PUBLISHED / reading
    names = ("figure3", "figure4", "figure6")
    measured = (RowIndex(rows_of(folder / f"{name}.csv")) for name in names)
    with open(folder / "claims.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row.pop("reading") for row in rows} == {reading}
    published = [Verdict(**row) for row in rows]
    assert published[2:] == judge(Evidence(*measured))
    assert [each.claim for each in published] == CLAIMS
