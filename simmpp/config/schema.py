"""The keys of a configuration as a JSON schema, so that editors complete and check a YAML file."""

from __future__ import annotations

import re
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from simmpp.common.yamlfile import written
from simmpp.config.axes import MOST_VALUES, NAME, POINTS, UNSWEPT
from simmpp.config.keys import NAME as ANY
from simmpp.config.keys import keys
from simmpp.config.reading import MACHINE, Reading, load_reading
from simmpp.config.settings import DEFAULT_READING, Settings


def json_schema() -> dict[str, Any]:
    """The schema (draft 2020-12); what it accepts may still be refused for values that disagree."""
    schema = _tidy(Settings.model_json_schema())
    schema["properties"]["sweep"] |= _sweep()
    _drop_defaults(schema, load_reading(DEFAULT_READING))
    return {"$schema": GenerateJsonSchema.schema_dialect, "title": "simmpp", **schema}


def _drop_defaults(schema: dict[str, Any], reading: Reading) -> None:
    """Those that the reading has otherwise: that policies differ in one no schema can say."""
    for line in reading.lines:
        part, *_, key = line.key.split(".")
        if part != MACHINE:
            _, _, holder, _, key = keys()[f"{part}.{key}"].pointer.split("/")
            described = schema["$defs"][holder]["properties"][key]
            if written(described.get("default")) != line.value:
                described.pop("default", None)


def _tidy(node: Any) -> Any:
    """Without titles that repeat names, and defaults that say nothing or a mapping's again."""
    if isinstance(node, dict):
        kept = {key: _tidy(child) for key, child in node.items()}
        if isinstance(kept.get("title"), str):
            del kept["title"]
        if isinstance(text := kept.get("description"), str):
            kept["description"] = " ".join(text.split())
        if "default" in kept and not _says_something(kept["default"]):
            del kept["default"]
        return kept
    return [_tidy(child) for child in node] if isinstance(node, list) else node


def _says_something(default: object) -> bool:
    plain = default[0] if isinstance(default, list) and default else default
    return plain is not None and not isinstance(plain, dict)


def _sweep() -> dict[str, Any]:
    """Axes take lists of what their keys take; keys with commas take lists of lists."""
    swept = {
        name: {"$ref": key.pointer}
        for name, key in keys().items()
        if name.split(".")[0] not in UNSWEPT
    }
    named = {
        f"^{re.escape(name).replace(ANY, '[A-Za-z0-9_-]+')}$": swept.pop(name)
        for name in list(swept)
        if f".{ANY}." in name
    }
    point = {
        "type": "object",
        "properties": {NAME: {"type": "string", "minLength": 1}, **swept},
        "patternProperties": named,
        "required": [NAME],
        "additionalProperties": False,
    }
    return {
        "type": "object",
        "properties": {name: _axis(values) for name, values in (swept | {POINTS: point}).items()},
        "patternProperties": {
            ",": _axis({"type": "array"}),
            **{pattern: _axis(values) for pattern, values in named.items()},
        },
        "additionalProperties": False,
    }


def _axis(values: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": values, "minItems": 1, "maxItems": MOST_VALUES}
