"""Loops in a policy's file are counted: one that never ends is an error like any other.

Compiled code hears no signal and no timeout before it returns. So each loop of the file gets two
lines, which cost a hook a nanosecond a turn. What is left, such as loops in functions that loops
call, meets ``sweeps.deadline``: the worker is ended, where it is a sweep's own.
"""

from __future__ import annotations

import ast
from typing import TypeVar

MOST_TURNS = 10_000_000
"""Turns of all loops of one call of a function: some 10 ms, where hooks take 10 ns (ESTIMATE)."""
_TURNS = "_turns_of_loops"
_COUNT = f"""
{_TURNS} += 1
if {_TURNS} > {MOST_TURNS}:
    raise RuntimeError("a loop of more than {MOST_TURNS} turns")
"""
Scope = TypeVar("Scope", ast.Module, ast.FunctionDef)
Loop = TypeVar("Loop", ast.For, ast.While)


def counted(source: str, file: str) -> ast.Module:
    """The code of a file, its loops counted; lines are those of the file.

    Raises SyntaxError.
    """
    return ast.fix_missing_locations(_Counting().visit(ast.parse(source, file)))


class _Counting(ast.NodeTransformer):
    def visit_Module(self, node: ast.Module) -> ast.Module:
        return self._scope(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        return self._scope(node)

    def visit_For(self, node: ast.For) -> ast.For:
        return self._loop(node)

    def visit_While(self, node: ast.While) -> ast.While:
        return self._loop(node)

    def _scope(self, node: Scope) -> Scope:
        """What has a counter of its own, which is 0 when it begins."""
        self.generic_visit(node)
        # behind the docstring and what is imported from __future__, which have to be first
        at = next((n for n, each in enumerate(node.body) if not _is_first(each)), len(node.body))
        begin = ast.parse(f"{_TURNS} = 0").body[0]
        node.body.insert(at, begin)
        return node

    def _loop(self, node: Loop) -> Loop:
        self.generic_visit(node)
        count = ast.parse(_COUNT).body
        for statement in count:
            for each in ast.walk(statement):
                ast.copy_location(each, node)
        node.body[:0] = count
        return node


def _is_first(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.ImportFrom):
        return statement.module == "__future__"
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
