"""Tables as files: the same cells in CSV and Parquet, whole files only."""

import os
from pathlib import Path

import pytest
from pyarrow import parquet

from simmpp.common.files import write_csv, write_parquet, write_text

COLUMNS = ("whole", "real", "mixed", "word", "nothing", "gaps")
ROWS = [
    {"whole": 2**60, "real": 0.1, "mixed": 1, "word": "a", "nothing": "", "gaps": ""},
    {"whole": 1, "real": 1.0, "mixed": "12%", "word": "b", "nothing": "", "gaps": 2**60 + 1},
]


def test_csv_has_all_digits(tmp_path: Path) -> None:
    write_csv(ROWS, COLUMNS, tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_bytes() == (
        b"whole,real,mixed,word,nothing,gaps\n"
        b"1152921504606846976,0.1,1,a,,\n"
        b"1,1.0,12%,b,,1152921504606846977\n"
    )


def test_parquet_has_the_same_cells(tmp_path: Path) -> None:
    write_parquet(ROWS, COLUMNS, tmp_path / "t.parquet")
    table = parquet.read_table(tmp_path / "t.parquet")
    assert [str(field.type) for field in table.schema] == [
        "int64", "double", "string", "string", "string", "int64",
    ]  # fmt: skip
    assert table.to_pylist()[1] == {
        "whole": 1, "real": 1.0, "mixed": "12%", "word": "b", "nothing": None, "gaps": 2**60 + 1,
    }  # fmt: skip


def test_a_failed_write_leaves_what_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "t.csv"
    write_text("before", path)
    with pytest.raises(KeyError):
        write_csv([*ROWS, {}], COLUMNS, path)
    assert path.read_text() == "before"
    monkeypatch.setattr(os, "replace", lambda *names: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_text("after", path)
    assert os.listdir(tmp_path) == ["t.csv"]
