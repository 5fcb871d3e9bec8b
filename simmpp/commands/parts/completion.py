"""Completion in shells: commands that only know their words, and what completes a word."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from glob import iglob
from typing import Any

import click
from click.shell_completion import BashComplete, CompletionItem, add_completion_class

from simmpp.commands.parts.words import POLICIES, PRESETS, READINGS, SCENES, words

PROFITS, DEEPEST = "profits.csv", 5
"""What names a baseline, and folders in folders that it may lie in."""
Items = list[CompletionItem[str]]
Complete = Callable[[click.Context, click.Parameter, str], Items]


def command(name: str) -> click.Command:
    """What completes the command so called, without importing it."""
    return _command(name, words()["commands"][name])


def _command(name: str, said: dict[str, Any]) -> click.Command:
    about: dict[str, Any] = {
        "params": [_parameter(each) for each in said["parameters"]],
        "help": said["help"],
    }
    inner = [_command(other, each) for other, each in said["commands"].items()]
    return click.Group(name, commands=inner, **about) if inner else click.Command(name, **about)


def _parameter(said: dict[str, Any]) -> click.Parameter:
    names = said["names"]
    complete = _COMPLETE.get(names[0]) or (_files if said["is_path"] else _one_of(said["choices"]))
    if names[0].startswith("-"):
        return click.Option(
            names,
            is_flag=said["is_flag"],
            multiple=said["multiple"],
            help=said["help"],
            shell_complete=complete,
        )
    return click.Argument(names, required=False, nargs=said["nargs"], shell_complete=complete)


def _begun(texts: Iterable[str], incomplete: str) -> Items:
    return [CompletionItem(text) for text in texts if text.startswith(incomplete)]


def _one_of(choices: Iterable[str]) -> Complete:
    return lambda ctx, param, incomplete: _begun(choices, incomplete)


def _named(kind: str, *, or_files: bool = False) -> Complete:
    """Names of a kind; where none begins so, files."""

    def complete(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
        return _begun(words()[kind], incomplete) or (
            _files(ctx, param, incomplete) if or_files else []
        )

    return complete


def _files(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
    return [CompletionItem(incomplete, type="file")]


def _policies(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
    """The last of a list."""
    before, comma, _ = incomplete.rpartition(",")
    return _begun((f"{before}{comma}{name}" for name in words()[POLICIES]), incomplete)


def _baselines(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
    """Those not far below this folder; else files."""
    found = (path for depth in range(1, DEEPEST) for path in iglob(f"{'*/' * depth}{PROFITS}"))
    return _begun(sorted(found), incomplete) or _files(ctx, param, incomplete)


def _keys(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
    return _begun(words()["keys"], incomplete)


def _assignments(ctx: click.Context, param: click.Parameter, incomplete: str) -> Items:
    """Keys with an equals sign, those of a sweep once it is begun, and then the key's values."""
    key, equals, _ = incomplete.partition("=")
    known: dict[str, list[str]] = words()["keys"]
    if equals:
        return _begun((f"{key}={value}" for value in known.get(key, ())), incomplete)
    prefix = "sweep." if key.startswith("sweep.") else ""
    return _begun((f"{prefix}{name}=" for name in known), incomplete)


_COMPLETE: dict[str, Complete] = {
    "--set": _assignments,
    "--policy": _policies,
    "--baseline": _baselines,
    "--reading": _named(READINGS, or_files=True),
    "spec": _named(SCENES, or_files=True),
    "preset": _named(PRESETS),
    "name": _named(READINGS, or_files=True),
    "key": _keys,
}
"""What completes an option or argument, by its name."""


@add_completion_class
class Bash(BashComplete):
    """Bash, which takes ``scene=mountain:5`` for five words, and gets the last of them back."""

    source_template = BashComplete.source_template.replace(
        "COMPREPLY+=($value)",
        "COMPREPLY+=($value)\n            [[ $value == *[=,] ]] && compopt -o nospace",
    )

    def get_completion_args(self) -> tuple[list[str], str]:
        """The words before the one to complete, and that one, as a user sees them."""
        args, incomplete = super().get_completion_args()
        joined, is_glued = [""], False
        for word in (*args, incomplete):
            breaks = bool(re.fullmatch("[=:]+", word))
            if breaks and joined[-1].startswith("--"):  # --set=scene
                joined.append("")
            elif is_glued or breaks:
                joined[-1] += word
            else:
                joined.append(word)
            is_glued = breaks
        self._cut = len(re.sub("[^=:]*$", "", joined[-1]))
        return joined[1:-1], joined[-1]

    def format_completion(self, item: CompletionItem[Any]) -> str:
        """Without what stands before the last word of them."""
        item.value = item.value[self._cut :] if item.type == "plain" else item.value
        return super().format_completion(item)
