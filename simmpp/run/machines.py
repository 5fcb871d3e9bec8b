"""Which machine a row is of: a record has all machines, and says whose they are if it has to.

Rows have the values of swept keys in columns. Machines that have one number of PEs, but not the
same constants, are told by those columns that may change a machine.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from math import prod
from typing import Any

from simmpp.common.files import Row
from simmpp.config.axes import POINTS
from simmpp.config.defaults import READING

MACHINE_OF = "machine_of"
"""Key of a record: columns with their cells, and the number of the machine in ``machines``."""
_NUMBER = "machine"
_OTHERS = ("processors", POINTS.removesuffix("s"), READING)


def changes_machines(column: str) -> bool:
    """Whether a column of swept keys, or the number of PEs, may tell machines apart."""
    return column.split(".")[0] == "machine" or column in _OTHERS


def machines_told(
    constants: Sequence[Mapping[str, Any]], told: Iterable[tuple[Mapping[str, Any], int]]
) -> list[dict[str, Any]]:
    """An entry for each machine of each point; none where numbers of PEs tell them apart."""
    if len({prod(of["shape"]) for of in constants}) == len(constants):
        return []
    entries: dict[str, dict[str, Any]] = {}
    for cells, number in told:
        at = {name: cell for name, cell in cells.items() if changes_machines(name)}
        entries.setdefault(json.dumps(at), {"at": at, _NUMBER: number})
    return list(entries.values())


def machine_of(record: Mapping[str, Any], row: Row) -> Mapping[str, Any] | None:
    """The constants of a row's machine, if the record tells; it may be another version's."""
    machines = record.get("machines")
    machines = [of for of in machines if isinstance(of, dict)] if isinstance(machines, list) else []
    entries = record.get(MACHINE_OF)
    for entry in entries if isinstance(entries, list) else []:
        at = entry.get("at") if isinstance(entry, dict) else None
        if isinstance(at, dict) and all(_same(row.get(name), cell) for name, cell in at.items()):
            number = entry.get(_NUMBER)
            return machines[number] if number in range(len(machines)) else None
    alike = [of for of in machines if _processors(of) == row["processors"]]
    return alike[0] if len(alike) == 1 and not entries else None


def _same(one: object, other: object) -> bool:
    """Cells of tables are read as texts and numbers again."""
    return one == other or str(one) == str(other)


def _processors(constants: Mapping[str, Any]) -> int | None:
    shape = constants.get("shape")
    if isinstance(shape, list | tuple) and all(isinstance(n, int) for n in shape):
        return prod(shape)
    return None
