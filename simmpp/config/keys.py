"""The table of configuration keys, as Markdown, made from the settings themselves.

``python -m simmpp.config.keys`` prints it; ``python -m simmpp.config.keys configs/README.md`` puts
it between the markers of a file.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from simmpp.common.strict import expectation, submodel
from simmpp.config.settings import Settings
from simmpp.machine.constants import CopiesConstants

BEGIN, END = "<!-- keys: generated -->", "<!-- /keys -->"
HEADER = "| key | default | takes | meaning |\n|---|---|---|---|\n"
FROM_PRESET = "preset's"


def key_table() -> str:
    """A Markdown table with one line per key: default, range and unit, meaning."""
    return HEADER + "".join(f"| {' | '.join(line)} |\n" for line in _lines(Settings, ""))


def _lines(model: type[BaseModel], prefix: str) -> Iterator[tuple[str, str, str, str]]:
    for key, field in model.model_fields.items():
        inner = submodel(model, key)
        if model is CopiesConstants and inner:
            continue  # the kinds of messages take what pack and unpack take
        expected = expectation(model, key)
        takes = expected.text if expected else "a mapping of the keys below"
        default = "" if inner else _default(prefix, field.get_default())
        if field.is_required():
            default = "(required)"
        meaning = (field.description or "") + _more(model, key)
        yield f"`{prefix}{key}`", default, takes, meaning
        if inner:
            yield from _lines(inner, f"{prefix}{key}.")


def _more(model: type[BaseModel], key: str) -> str:
    if submodel(model, key) is CopiesConstants:
        return "; `.request`, `.object`, `.rays`, `.load` inside take both keys for one kind"
    return ""


def _default(prefix: str, value: Any) -> str:
    if value is None:
        return FROM_PRESET if prefix.startswith("machine.") else "none"
    if isinstance(value, Fraction):
        return f"{float(value):.0%}"
    if isinstance(value, bool):
        return str(value).lower()
    return str(list(value) if isinstance(value, tuple) else value)


def with_table(text: str) -> str:
    """``text`` with the present table between its markers.

    Raises ValueError if the markers are missing.
    """
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"expected the markers {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{key_table()}{END}{after}"


def main(arguments: list[str]) -> None:
    """Print the table, or bring the one of a file up to date."""
    if not arguments:
        print(key_table(), end="")
        return
    path = Path(arguments[0])
    path.write_text(with_table(path.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
