"""Which source a module depends on: its own, and that of all it imports of this package."""

from __future__ import annotations

import ast
import hashlib
import sys
from functools import cache
from pathlib import Path

PACKAGE = __name__.partition(".")[0]


def source_digest(*modules: str) -> str:
    """Hexadecimal hash of the source of modules and of all that they import of this package."""
    digest = hashlib.sha256()
    for name in sorted(set[str]().union(*map(closure, modules))):
        digest.update(_source(name).encode())
    return digest.hexdigest()[:16]


def closure(module: str) -> set[str]:
    """The module and all modules of this package that it imports, directly or not."""
    found: set[str] = set()
    pending = [module]
    while pending:
        name = pending.pop()
        if name not in found:
            found.add(name)
            pending.extend(_imports(_source(name)))
    return found


@cache
def _imports(source: str) -> frozenset[str]:
    """Modules of this package that a source imports, wherever in it: functions import, too.

    What only type checkers read is left out. Kept, as parsing takes milliseconds and every compiled
    function asks for the digest of its module.
    """
    modules: set[str] = set()
    pending: list[ast.AST] = [ast.parse(source)]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        pending.extend(ast.iter_child_nodes(node))
        if isinstance(node, ast.Import):
            modules.update(filter(_is_ours, (alias.name for alias in node.names)))
        elif isinstance(node, ast.ImportFrom) and _is_ours(node.module or ""):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            modules.update(name if file_of(name) else str(node.module) for name in names)
    return frozenset(modules)


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == PACKAGE


@cache
def _source(module: str) -> str:
    """The text of one module. Raise a ModuleNotFoundError if it has no file.

    A digest that left it out would find stale code and stale workloads for ever.
    """
    file = file_of(module)
    if file is None:
        raise ModuleNotFoundError(f"no file holds the source of {module}")
    return file.read_text(encoding="utf-8")


@cache
def file_of(module: str) -> Path | None:
    """Where a module's source is; others than this package's have to be imported already."""
    if _is_ours(module):
        path = Path(__file__).parents[2].joinpath(*module.split(".")[1:])
        files = (path.with_suffix(".py"), path / "__init__.py")
        return next((file for file in files if file.is_file()), None)
    loaded = getattr(sys.modules.get(module), "__file__", None)
    return Path(loaded) if loaded else None
