"""What is read of a folder, and how it is told that there is nothing to read."""

from __future__ import annotations

from pathlib import Path

import pytest
from sweep_rows import failed, row, sweep, written

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv
from simmpp.methods.columns import result_columns
from simmpp.report.page.folder import read_folder
from simmpp.run.rows import in_order
from simmpp.studies.nebel98.reproduce import EXPERIMENTS

NEBEL98 = Path(__file__).parents[4] / "experiments" / "nebel98" / "plain"


def test_rows_are_read_as_they_were_written(tmp_path: Path) -> None:
    further = ("memory.transient", "point")
    rows = [
        each | {"memory.transient": 4, "point": 'slow, "network"'}
        for each in [*sweep(fraction=[0.1, 1.0]), failed(seed=9), row(seed=8, fraction="")]
    ]
    found = read_folder(written(tmp_path, rows, further))
    assert found.rows == in_order(rows, further)
    assert found.further == further
    assert len(found.failed) == 1


def test_swept_values_are_numbers_where_they_look_like_some(tmp_path: Path) -> None:
    rows = [row(seed=n, key=value) for n, value in enumerate([3, 0.5, "nan", "12 us", "[2, 2]"])]
    found = read_folder(written(tmp_path, rows, ("key",)))
    assert {each["key"] for each in found.rows} == {3, 0.5, "nan", "12 us", "[2, 2]"}


def test_points_that_several_experiments_have_are_there_once(tmp_path: Path) -> None:
    rows = sweep(fraction=[0.1, 0.2])
    for name in EXPERIMENTS[:2]:
        write_csv(rows, result_columns(), tmp_path / f"{name}.csv")
    found = read_folder(tmp_path)
    assert found.rows == in_order(rows)
    assert set(found.experiments) == set(EXPERIMENTS[:2])


def test_the_published_rows_are_read() -> None:
    found = read_folder(NEBEL98)
    assert len(found.rows) == 3584  # 4224 of the figures, 640 of them twice
    assert len(found.claims) == 13


def refused(folder: Path) -> str:
    with pytest.raises(ConfigError) as error:
        read_folder(folder)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_folder_without_rows_is_refused(tmp_path: Path) -> None:
    assert "there are no rows: expected results.csv" in refused(tmp_path)
    assert "expected a folder" in refused(tmp_path / "none")


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("makespan_ps", "makespan", "results.csv lacks the column makespan_ps"),
        (",1952,", ",many,", "results.csv:2: column messages: value 'many': expected an integer"),
        (",0.5,", ",nan,", "results.csv:2: column fraction: value 'nan': expected a number"),
        (",7,\n", ",7\n", "results.csv:2 has 25 cells, not 26"),
        (",1000000000000,", ",,", "results.csv:2: expected results or an error"),
        ("mountain:4", '"mountain:4', "damaged"),
    ],
)
def test_what_is_damaged_is_told_with_its_place(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    file = written(tmp_path, [row(), row("ray")]) / "results.csv"
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert told in refused(tmp_path)


@pytest.mark.parametrize("text", ["{", "[]"])
def test_a_damaged_record_is_told(tmp_path: Path, text: str) -> None:
    written(tmp_path, [row()])
    (tmp_path / "run.json").write_text(text, encoding="utf-8")
    assert "run.json: damaged" in refused(tmp_path)
