"""Tables as files: the same cells in CSV and Parquet, whole files only."""

import os
from pathlib import Path

import pytest
from pyarrow import parquet

from simmpp.common.files import replaced, write_csv, write_parquet, write_text

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


def test_a_full_disk_is_told_with_the_file(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    write_text("before", path)
    with pytest.raises(OSError, match="No space left") as error, replaced(path) as part:
        part.symlink_to("/dev/full")
        part.write_text("x")
    assert error.value.filename == str(path)
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["t.csv"]


def test_two_writers_of_one_file_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    with replaced(path) as one, replaced(path) as other:
        one.write_text("1")
        other.write_text("2")
    assert path.read_text() == "1"  # who ends last
    assert os.listdir(tmp_path) == ["t.csv"]


def test_names_may_be_as_long_as_they_can_be(tmp_path: Path) -> None:
    write_text("x", tmp_path / ("n" * 255))


def test_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "link.csv").symlink_to("t.csv")
    write_text("x", tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "t.csv").read_text() == "x"


def test_what_is_no_file_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="expected a regular file"):
        write_text("x", tmp_path / "pipe")
    assert (tmp_path / "pipe").is_fifo()


def test_names_that_are_not_utf8_do_not_stop_a_table(tmp_path: Path) -> None:
    rows = [{"name": os.fsdecode(b"n\xfc"), "number": 1}]
    write_csv(rows, ("name", "number"), tmp_path / "t.csv")
    write_parquet(rows, ("name", "number"), tmp_path / "t.parquet")
    assert (tmp_path / "t.csv").read_text() == "name,number\nn?,1\n"
    assert parquet.read_table(tmp_path / "t.parquet").to_pylist() == [{"name": "n?", "number": 1}]
