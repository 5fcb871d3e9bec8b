"""Rays and objects in two Parquet files side by side."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray
from pyarrow import parquet

from simmpp.common.errors import WorkloadError
from simmpp.common.files import refuse_special, replaced
from simmpp.workload.exchange.columns import (
    DEPOSIT_OFFSETS,
    DEPOSITS,
    LONGEST_WORD,
    MOST_ROWS,
    OBJECT_COLUMNS,
    RAY_COLUMNS,
    CheckedTable,
    Column,
    Content,
)

NULL_MEANS_NONE = ("parent", "hit", "home")
"""Columns in which a missing value is the same as -1."""
PICTURE = b"picture"
"""Key of the metadata of the rays' schema: rows and columns of primary rays, as ``512 512``, and
how many each pixel has, if it is not one."""


PANDAS_INDEX = re.compile(r"__index_level_\d+__")
"""Columns that pandas adds: row numbers by which nothing here is found."""


def objects_path(path: Path) -> Path:
    """The table of objects beside one of rays: forest.parquet, forest.objects.parquet."""
    return path.with_suffix(f".objects{path.suffix}")


def read(path: Path) -> Content:
    """Both tables; raises WorkloadError, or OSError and ValueError for what is no Parquet."""
    try:
        return _tables(path)
    except pa.ArrowException as error:
        raise ValueError(str(error)) from None


def _tables(path: Path) -> Content:
    beside = objects_path(path)
    if not beside.exists():
        expected = f"expected the table of objects beside it, {beside.name}"
        raise WorkloadError(expected, where=str(path))
    rays, metadata = _table(path, RAY_COLUMNS)
    objects, _ = _table(beside, OBJECT_COLUMNS)
    text = metadata.get(PICTURE)
    picture = None if text is None else np.array([int(word) for word in text.split()])
    return Content(rays, objects, picture)


def write(tables: Content, path: Path) -> None:
    """Write both tables; words as dictionaries, itineraries as lists."""
    columns = dict(tables.rays.columns)
    offsets, objects = columns.pop("itinerary_offsets"), columns.pop("itinerary_objects")
    lists = {"itinerary": objects}
    if DEPOSITS in columns:
        lists["deposit"] = columns.pop(DEPOSITS)
    of_rays = {n: pa.LargeListArray.from_arrays(offsets, all_) for n, all_ in lists.items()}
    rays = pa.table(columns | of_rays)
    if tables.picture is not None:
        rays = rays.replace_schema_metadata({PICTURE: " ".join(map(str, tables.picture))})
    for table, name in ((pa.table(dict(tables.objects.columns)), objects_path(path)), (rays, path)):
        with replaced(name) as part, open(part, "wb") as file:
            parquet.write_table(table, file)


def _table(path: Path, known: Sequence[str]) -> tuple[CheckedTable, dict[bytes, bytes]]:
    parts = _parts(path)
    rows = sum(part.num_rows for part in parts)
    if rows > MOST_ROWS:
        raise WorkloadError(f"{rows} rows: expected at most {MOST_ROWS}", where=str(path))
    data = pa.concat_tables(parts, promote_options="permissive")
    names = [name for name in data.column_names if not PANDAS_INDEX.fullmatch(name)]
    # A misspelt one is told as such, before what it holds is found to fit nothing.
    CheckedTable(str(path), "", rows, dict.fromkeys(names, np.empty(0))).known(known)
    table = CheckedTable(str(path), "", rows, {})
    for name in names:
        chunk = data[name].combine_chunks()
        if name == "itinerary":
            table.columns.update(_itineraries(table, chunk))
        elif name == "deposit" and known is RAY_COLUMNS:
            table.columns.update(_deposits(table, chunk))
        else:
            table.columns[name] = _column(table, name, chunk)
    return table, dict(data.schema.metadata or {})


def _parts(path: Path) -> list[pa.Table]:
    """The table of a file, or those of a folder's files *.parquet by name."""
    files = [path]
    if path.is_dir():
        files = sorted(file for file in path.glob("*.parquet") if file.name[0] not in "._")
        if not files:
            raise WorkloadError("expected files *.parquet in this folder", where=str(path))
    parts = [_part(file) for file in files]
    for file, part in zip(files, parts, strict=True):
        if other := set(part.column_names) ^ set(parts[0].column_names):
            problem = f"column {min(other)}: only one of this file and {files[0].name} has it"
            raise WorkloadError(problem, where=str(file))
    return parts


def _part(path: Path) -> pa.Table:
    """One file's table, words as such: each file has its own dictionary of them."""
    refuse_special(path)
    with path.open("rb") as opened, parquet.ParquetFile(opened) as file:
        names = file.schema_arrow.names
        for name in names:
            if names.count(name) > 1:
                CheckedTable(str(path), "", 0, {}).fail(name, "two columns have this name")
        data = file.read()
    for number, field in enumerate(data.schema):
        if pa.types.is_dictionary(field.type):
            words = data[field.name].cast(field.type.value_type)
            data = data.set_column(number, field.name, words)
    return data


def _column(table: CheckedTable, name: str, array: pa.Array) -> Column:
    if name in NULL_MEANS_NONE:
        array = _with_none(table, name, array)
    _refuse_nulls(table, name, array)
    if pa.types.is_string(array.type) or pa.types.is_large_string(array.type):
        words = pc.utf8_slice_codeunits(array, 0, LONGEST_WORD)
        return words.to_numpy(zero_copy_only=False).astype(f"U{LONGEST_WORD}")
    if not (pa.types.is_integer(array.type) or pa.types.is_floating(array.type)):
        table.fail(name, f"it holds {array.type}, expected integers, numbers or text")
    return array.to_numpy(zero_copy_only=False)


def _with_none(table: CheckedTable, name: str, array: pa.Array) -> pa.Array:
    """-1 where a value is missing. pandas has floats then, and a column of nothing has no type."""
    if pa.types.is_null(array.type):
        return pa.array(np.full(len(array), -1))
    if pa.types.is_floating(array.type):
        numbers = array.to_numpy(zero_copy_only=False).astype(np.float64)
        missing = np.isnan(numbers)  # as nulls are, and as others write them
        if not missing.any():
            return array
        wrong = ~missing & ((numbers != np.rint(numbers)) | (np.abs(numbers) > MOST_ROWS))
        if wrong.any():
            row = int(np.argmax(wrong))
            problem = f"value {numbers[row]:g}: it holds {array.type}, expected integers"
            table.fail(name, problem, row)
        return pa.array(np.where(missing, -1, numbers).astype(np.int64))
    if pa.types.is_integer(array.type) and array.null_count:
        return array.cast(pa.int64()).fill_null(-1)
    return array


def _refuse_nulls(table: CheckedTable, name: str, array: pa.Array) -> None:
    if array.null_count:
        row = int(np.argmax(array.is_null().to_numpy(zero_copy_only=False)))
        table.fail(name, "the value is missing (null)", row)


def _itineraries(table: CheckedTable, array: pa.Array) -> dict[str, Column]:
    offsets, objects = _lists(table, "itinerary", array, "integers")
    if not len(objects):
        objects = pa.array([], pa.int32())  # a list of nothing may be a list of any type
    return {
        "itinerary_offsets": offsets,
        "itinerary_objects": objects.to_numpy(zero_copy_only=False),
    }


def _deposits(table: CheckedTable, array: pa.Array) -> dict[str, Column]:
    """With their offsets, which have to be the itineraries'."""
    offsets, numbers = _lists(table, "deposit", array, "numbers")
    if not len(numbers):
        numbers = pa.array([], pa.float64())
    return {DEPOSITS: numbers.to_numpy(zero_copy_only=False), DEPOSIT_OFFSETS: offsets}


def _lists(
    table: CheckedTable, name: str, array: pa.Array, what: str
) -> tuple[NDArray[np.int64], pa.Array]:
    """A list in each row, as CSR."""
    kind = array.type
    if not pa.types.is_list(kind) and not pa.types.is_large_list(kind):
        table.fail(name, f"it holds {kind}, expected lists of {what}")
    _refuse_nulls(table, name, array)
    values, lengths = array.flatten(), pc.list_value_length(array)
    offsets = np.concatenate([[0], np.cumsum(lengths.to_numpy(zero_copy_only=False))])
    if values.null_count:
        entry = int(np.argmax(values.is_null().to_numpy(zero_copy_only=False)))
        row = int(np.searchsorted(offsets, entry, side="right")) - 1
        missing = "an object" if what == "integers" else "a number"
        table.fail(name, f"{missing} is missing (null)", row)
    return offsets.astype(np.int64), values
