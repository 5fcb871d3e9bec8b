"""What a folder of a sweep may get more of, and what keeps it from taking another sweep.

Each simulation is known by all that decides it, so a journal could hold those of any sweeps. What
is refused is refused for people, for whom a folder, a policy's label or a point's name stands for
one thing: settings outside of the axes must be equal, and names must mean what they meant.
"""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from simmpp.config.axes import POINTS, SAME, Choice
from simmpp.config.config import Config, described
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.provenance import difference
from simmpp.sweeps.task import canonical, constants_of, decides

GROWS = ("seeds", "policy", "sweep", "tolerance", "max_seeds", "refine", "advise")
"""Keys of a configuration that say which points there are, and not what they are of."""
SWEPT, NAMES = "swept", "names"
"""Parts of an identity that grow: keys that are axes, and the meanings that each name has."""

FORMAT = "format"
"""The part that says how all others are written."""
Identity = Mapping[str, Any]
"""What results are of, as JSON can hold it: versions, the configuration, and those two."""


def meanings(
    policies: Iterable[tuple[PolicyParameters, str]],
    rays: Iterable[tuple[str, object, str]],
    configs: Iterable[tuple[Config, str]],
    points: Iterable[Choice],
) -> dict[str, list[Any]]:
    """What names stand for: of policies, of scenes (with what is asked of them), of points.

    Likewise what the settings of a machine give, which depends on its preset or file, too.
    """
    named = [(f"policy {p.title}{at}", decides(canonical(p))) for p, at in policies]
    named += [(f"point {p.columns[POINTS[:-1]]}", dict(p.assignments)) for p in points]
    named += [(f"{_machine(c)}{at}", constants_of(c)) for c, at in configs]
    names: dict[str, list[Any]] = {}
    for name, meaning in named:
        of_name = names.setdefault(name, [])
        as_read = json.loads(json.dumps(meaning, default=str))
        of_name += [as_read] if as_read not in of_name else []
    for scene, asked, digest in rays:
        names.setdefault(f"rays of {scene} (picture {_short(asked)})", []).append(digest)
    return names


def _machine(config: Config) -> str:
    return f"machine of {config.processors} PEs (settings {_short(described(config)['machine'])})"


def _short(said: object) -> str:
    return hashlib.sha256(repr(said).encode()).hexdigest()[:8]


def conflict(there: Identity, now: Identity) -> str:
    """What keeps the results of two sweeps from lying in one folder; empty if nothing does."""
    if there.get(FORMAT) != now.get(FORMAT):
        return difference({FORMAT: there.get(FORMAT)}, {FORMAT: now.get(FORMAT)})
    swept = {*there.get(SWEPT, ()), *now.get(SWEPT, ())}
    return difference(_outside(there, swept), _outside(now, swept)) or _renamed(
        there.get(NAMES, {}), now.get(NAMES, {})
    )


def joined(there: Identity, now: Identity) -> Identity:
    """The identity of the results of both."""
    if SWEPT not in now:
        return there
    names = {name: list(meanings) for name, meanings in there[NAMES].items()}
    for name, meanings in now[NAMES].items():
        known = names.setdefault(name, [])
        known += [meaning for meaning in meanings if meaning not in known]
    return {**there, SWEPT: sorted({*there[SWEPT], *now[SWEPT]}), NAMES: names}


def _outside(identity: Identity, swept: Iterable[str]) -> Identity:
    """The settings that are no axis, with all else that must be equal."""
    fixed = {key: copy.deepcopy(v) for key, v in identity.items() if key not in (SWEPT, NAMES)}
    for key in (*swept, *(SAME[key] for key in swept if key in SAME)):
        _remove(fixed.get("config"), key.split("."))
    return fixed


def _remove(node: Any, path: Sequence[str]) -> None:
    for part in path[:-1]:
        node = node.get(part) if isinstance(node, dict) else None
    if isinstance(node, dict):
        node.pop(path[-1], None)


def _renamed(there: Mapping[str, list[Any]], now: Mapping[str, list[Any]]) -> str:
    """The first name that lost a meaning and got another.

    Several meanings are fine: a policy may have other numbers at each value of a linked axis.
    """
    for name in filter(now.__contains__, there):
        lost = [meaning for meaning in there[name] if meaning not in now[name]]
        new = [meaning for meaning in now[name] if meaning not in there[name]]
        if lost and new:
            if isinstance(new[0], str):  # a digest
                return f"{name} are others now"
            return difference({name: lost[0]}, {name: new[0]})
    return ""
