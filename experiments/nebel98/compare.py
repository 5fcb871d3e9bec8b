"""What was expected of each claim beside what came out.

    python experiments/nebel98/compare.py [CLAIMS]

Reads expected.yaml, CLAIMS, the claims.csv of `simmpp reproduce --reading ...` (by default the one
here), and equal_memory.csv, and writes expected.csv: reading, claim, expected, found, hit or miss.
Prints the same as a table for README.md, and which reading the rule in expected.yaml makes the
default.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from simmpp.common.files import Row, read_csv, write_csv
from simmpp.common.yamlfile import read_yaml
from simmpp.config.defaults import READING
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS, HOLDS

HERE = Path(__file__).parent
CANDIDATES = ("plain", "mixed", "S1")
"""Of the rule, the nearest to plain first."""
COLUMNS = (READING, "claim", "expected", "found", "hit", "why")


def compared(expected: Mapping[str, Any], claims: Sequence[Mapping[str, str]]) -> list[Row]:
    """A row for each claim of each reading that has verdicts, in the order of ``expected``."""
    found = {(row[READING], row["claim"]): row["holds"] for row in claims}
    return [
        {
            READING: reading,
            "claim": claim,
            "expected": said["holds"],
            "found": found[reading, claim],
            "hit": "hit" if said["holds"] == found[reading, claim] else "miss",
            "why": said["why"],
        }
        for reading, about in expected["readings"].items()
        for claim, said in about["claims"].items()
        if (reading, claim) in found
    ]


def chosen(rows: Sequence[Row]) -> str:
    """The candidate of whose claims most hold; the first of several."""
    return max(CANDIDATES, key=lambda reading: held(rows, reading))


def held(rows: Sequence[Row], reading: str) -> int:
    """How many claims hold with a reading."""
    return sum(row[READING] == reading and row["found"] == HOLDS for row in rows)


def markdown(rows: Sequence[Row]) -> str:
    """A line for each claim, a column for each reading: what came out, and what it was not."""
    readings = list(dict.fromkeys(str(row[READING]) for row in rows))
    cells = {(row["claim"], row[READING]): _cell(row) for row in rows}
    claims = list(dict.fromkeys(str(row["claim"]) for row in rows))
    lines = [["claim", *readings], ["---"] * (len(readings) + 1)]
    lines += [[claim, *(cells.get((claim, name), "") for name in readings)] for claim in claims]
    hits = [[row["hit"] == "hit" for row in rows if row[READING] == name] for name in readings]
    lines += [["hold", *(str(held(rows, name)) for name in readings)]]
    lines += [["as expected", *(f"{sum(of)} of {len(of)}" for of in hits)]]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _cell(row: Row) -> str:
    found = str(row["found"])
    return found if row["hit"] == "hit" else f"**{found}** (expected: {row['expected']})"


def main(arguments: Sequence[str]) -> None:
    """Compare, write, print."""
    paths = (Path(arguments[0]) if arguments else HERE / "claims.csv", HERE / "equal_memory.csv")
    expected: Any = read_yaml(HERE / "expected.yaml").data
    claims = [row for path in paths for row in read_csv(path, (READING, *CLAIM_COLUMNS))]
    rows = compared(expected, claims)
    write_csv(rows, COLUMNS, HERE / "expected.csv")
    print(markdown(rows))
    print(f"by the rule the default is {chosen(rows)}, expected: {expected['expected_default']}")


if __name__ == "__main__":
    main(sys.argv[1:])
