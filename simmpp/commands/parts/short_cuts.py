"""Options for the keys that change most often; each stands for ``--set`` of its key."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple

import click

from simmpp.commands.parts import options
from simmpp.common.validate import MOST_SEED
from simmpp.config.short_cut import ShortCut


class _About(NamedTuple):
    """What an option sets."""

    key: str
    metavar: str
    help: str
    several: str = ""
    """Of a sweep."""


POLICY, PROCESSORS, FRACTION = "--policy", "--processors", "--fraction"
SEEDS, SEED = "--seeds", "--seed"
_ABOUT = {
    POLICY: _About("policy", "NAMES", "Policies to compare, such as ray,concurrent"),
    PROCESSORS: _About("processors", "N", "Number of PEs", ", or several: 8,64"),
    FRACTION: _About(
        "memory.fraction", "SHARE", "Share of the scene in each memory", ", or several: 5%,10%"
    ),
    SEEDS: _About("seeds", "N", "How many seeds (8: those from 0 to 7), or which, such as 0,5"),
    SEED: _About("seeds", "N", "The seed of the draws"),
}


def settings(help_of_set: str, *names: str, is_swept: bool = False) -> Callable[[Any], Any]:
    """``--set`` and short cuts of it, which the command gets together as ``overrides``.

    With ``is_swept`` all take several values, of which axes are made; else only policies do.
    """

    def decorated(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def called(*, overrides: tuple[str, ...], **others: Any) -> None:
            said = {name: others.pop(name.removeprefix("--")) for name in names}
            cuts = [
                ShortCut(name, _ABOUT[name].key, tuple(map(str, values)), is_swept)
                for name, values in said.items()
                if values
            ]
            command(overrides=(*overrides, *cuts), **others)

        options.setting(help_of_set)(called)
        for name in reversed(names):
            _option(name, is_swept)(called)
        return called

    return decorated


def _option(name: str, is_swept: bool) -> Callable[[Any], Any]:
    about = _ABOUT[name]
    return click.option(
        name,
        multiple=True,
        metavar=about.metavar,
        type=options.Whole(0, MOST_SEED) if name == SEED else str,
        help=f"{about.help}{about.several if is_swept else ''}.",
    )
