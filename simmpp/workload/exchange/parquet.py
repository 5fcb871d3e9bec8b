"""Rays and objects in two Parquet files side by side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from pyarrow import parquet

from simmpp.common.errors import WorkloadError
from simmpp.common.files import replaced
from simmpp.workload.exchange.columns import LONGEST_WORD, MOST_ROWS, CheckedTable, Column, Content

NULL_MEANS_NONE = ("parent", "hit")
"""Columns in which a missing value is the same as -1."""
PICTURE = b"picture"
"""Key of the metadata of the rays' schema: rows and columns of primary rays, as ``512 512``."""


def objects_path(path: Path) -> Path:
    """The file of objects beside one of rays: forest.parquet, forest.objects.parquet."""
    return path.with_suffix(f".objects{path.suffix}")


def read(path: Path) -> Content:
    """Both tables; raises WorkloadError, or OSError and ValueError for what is no Parquet."""
    try:
        return _tables(path)
    except pa.ArrowException as error:
        raise ValueError(str(error)) from None


def _tables(path: Path) -> Content:
    beside = objects_path(path)
    if not beside.is_file():
        expected = f"expected the table of objects beside it, {beside.name}"
        raise WorkloadError(expected, where=str(path))
    rays, metadata = _table(path)
    objects, _ = _table(beside)
    text = metadata.get(PICTURE)
    picture = None if text is None else np.array([int(word) for word in text.split()])
    return Content(rays, objects, picture)


def write(tables: Content, path: Path) -> None:
    """Write both tables; words as dictionaries, itineraries as lists."""
    columns = dict(tables.rays.columns)
    offsets, objects = columns.pop("itinerary_offsets"), columns.pop("itinerary_objects")
    rays = pa.table(columns | {"itinerary": pa.LargeListArray.from_arrays(offsets, objects)})
    if tables.picture is not None:
        rays = rays.replace_schema_metadata({PICTURE: " ".join(map(str, tables.picture))})
    with replaced(objects_path(path)) as part:
        parquet.write_table(pa.table(dict(tables.objects.columns)), part)
    with replaced(path) as part:
        parquet.write_table(rays, part)


def _table(path: Path) -> tuple[CheckedTable, dict[bytes, bytes]]:
    with parquet.ParquetFile(path) as file:
        rows, names = file.metadata.num_rows, file.schema_arrow.names
        if rows > MOST_ROWS:
            raise WorkloadError(f"{rows} rows: expected at most {MOST_ROWS}", where=str(path))
        table = CheckedTable(str(path), "", rows, {})
        for name in names:
            if names.count(name) > 1:
                table.fail(name, "two columns have this name")
        data = file.read()
        for name in names:
            chunk = data[name].combine_chunks()
            if name == "itinerary":
                table.columns.update(_itineraries(table, chunk))
            else:
                table.columns[name] = _column(table, name, chunk)
        return table, dict(file.schema_arrow.metadata or {})


def _column(table: CheckedTable, name: str, array: pa.Array) -> Column:
    if pa.types.is_dictionary(array.type):
        array = array.dictionary_decode()
    if name in NULL_MEANS_NONE and array.null_count and pa.types.is_integer(array.type):
        array = array.cast(pa.int64()).fill_null(-1)
    _refuse_nulls(table, name, array)
    if pa.types.is_string(array.type) or pa.types.is_large_string(array.type):
        words = pc.utf8_slice_codeunits(array, 0, LONGEST_WORD)
        return words.to_numpy(zero_copy_only=False).astype(f"U{LONGEST_WORD}")
    if not (pa.types.is_integer(array.type) or pa.types.is_floating(array.type)):
        table.fail(name, f"it holds {array.type}, expected integers, numbers or text")
    return array.to_numpy(zero_copy_only=False)


def _refuse_nulls(table: CheckedTable, name: str, array: pa.Array) -> None:
    if array.null_count:
        row = int(np.argmax(array.is_null().to_numpy(zero_copy_only=False)))
        table.fail(name, "the value is missing (null)", row)


def _itineraries(table: CheckedTable, array: pa.Array) -> dict[str, Column]:
    kind = array.type
    if not pa.types.is_list(kind) and not pa.types.is_large_list(kind):
        table.fail("itinerary", f"it holds {kind}, expected lists of integers")
    _refuse_nulls(table, "itinerary", array)
    objects, lengths = array.flatten(), pc.list_value_length(array)
    offsets = np.concatenate([[0], np.cumsum(lengths.to_numpy(zero_copy_only=False))])
    if objects.null_count:
        entry = int(np.argmax(objects.is_null().to_numpy(zero_copy_only=False)))
        row = int(np.searchsorted(offsets, entry, side="right")) - 1
        table.fail("itinerary", "an object is missing (null)", row)
    if not len(objects):
        objects = pa.array([], pa.int32())  # a list of nothing may be a list of any type
    return {
        "itinerary_offsets": offsets.astype(np.int64),
        "itinerary_objects": objects.to_numpy(zero_copy_only=False),
    }
