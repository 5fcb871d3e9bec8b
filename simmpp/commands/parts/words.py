"""Words that a shell completes: options of commands, keys and their values, scenes and so on.

Pressing a key must not import numba. So they are collected once, kept in the cache folder, and
collected anew when a file of the package is another one.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import click

import simmpp
from simmpp.common.cache import cache_folder
from simmpp.common.files import write_text

FILE = "completion.json"
POLICIES, SCENES, PRESETS, READINGS = "policies", "scenes", "presets", "readings"
"""Kinds of names."""


@cache
def words() -> dict[str, Any]:
    """All words, by their kind."""
    path, stamp = cache_folder() / FILE, _stamp()
    with suppress(OSError, ValueError, TypeError, KeyError):
        known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if known["of"] == stamp:
            return known
    found = {"of": stamp, **collected()}
    with suppress(OSError):  # then the next time takes as long
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(json.dumps(found), path)
    return found


def _stamp() -> str:
    """Which files the package has, and of when."""
    package, digest = Path(simmpp.__file__).parent, sha256()
    for path in sorted(path for ending in ("py", "yaml") for path in package.rglob(f"*.{ending}")):
        about = path.stat()
        digest.update(f"{path} {about.st_mtime_ns} {about.st_size}\n".encode())
    return digest.hexdigest()


def collected() -> dict[str, Any]:
    """The words, from where each is declared."""
    from simmpp import commands as package
    from simmpp.config.keys import keys
    from simmpp.config.reading import reading_names
    from simmpp.config.schema import json_schema
    from simmpp.machine.presets import preset_names
    from simmpp.policy.parameters import POLICIES as RULES
    from simmpp.scene.spd.generators import GENERATORS

    schema = json_schema()
    commands = [module.name for module in iter_modules(package.__path__) if not module.ispkg]
    scenes = [f"{scene.name}:{scene.default_size}" for scene in GENERATORS.values()]
    names = {
        POLICIES: list(RULES),
        SCENES: scenes,
        PRESETS: preset_names(),
        READINGS: reading_names(),
    }
    values = {key.name: _values(schema, _at(schema, key.pointer)) for key in keys().values()}
    values |= {"scene": scenes, "reading": names[READINGS]}
    holders = {name.rpartition(".")[0] for name in values} - {"scene", "policy"}
    return {
        **names,
        "keys": {name: values[name] for name in values if name not in holders},
        "commands": {name: _described(_command(name)) for name in commands},
    }


def _command(name: str) -> click.Command:
    command: click.Command = getattr(import_module(f"simmpp.commands.{name}"), f"{name}_command")
    return command


def _described(command: click.Command) -> dict[str, Any]:
    """What must be known of a command, and of those in it, to complete its words."""
    inner = command.commands if isinstance(command, click.Group) else {}
    return {
        "help": command.get_short_help_str(),
        "parameters": _parameters(command),
        "commands": {name: _described(one) for name, one in inner.items()},
    }


def _parameters(command: click.Command) -> list[dict[str, Any]]:
    return [
        {
            "names": [*param.opts, *param.secondary_opts],
            "is_flag": isinstance(param, click.Option) and param.is_flag,
            "multiple": param.multiple,
            "nargs": param.nargs,
            "help": getattr(param, "help", "") or "",
            "is_path": isinstance(param.type, click.Path),
            "choices": list(getattr(param.type, "choices", ())),
        }
        for param in command.params
    ]


def _at(schema: Mapping[str, Any], pointer: str) -> Any:
    node: Any = schema
    for part in pointer.removeprefix("#/").split("/"):
        node = node[part]
    return node


def _values(schema: Mapping[str, Any], node: Any) -> list[str]:
    """The words that a key takes."""
    return [str(word).lower() if isinstance(word, bool) else word for word in _words(schema, node)]


def _words(schema: Mapping[str, Any], node: Mapping[str, Any]) -> Iterator[Any]:
    if node.get("type") == "boolean":
        yield from (True, False)
    for word in [*node.get("enum", ()), *([node["const"]] if "const" in node else [])]:
        if isinstance(word, str):
            yield word
    for option in node.get("anyOf", ()):
        yield from _words(schema, option)
