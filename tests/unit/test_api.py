"""``import simmpp``: each name is where it is said to be, and is imported when it is first used."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from importlib import import_module

import pytest

import simmpp


@pytest.mark.parametrize("name", simmpp.__all__)
def test_a_name_is_where_it_is_said_to_be(name: str) -> None:
    module, _, attribute = simmpp._HOME[name].partition(":")
    assert getattr(simmpp, name) is getattr(import_module(module), attribute)


def test_type_checkers_see_the_same_names_from_the_same_places() -> None:
    tree = ast.parse(inspect.getsource(simmpp))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    seen = {
        alias.asname or alias.name: f"{node.module}:{alias.name}"
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert seen == simmpp._HOME
    assert sorted(seen) == sorted(simmpp.__all__)


def test_dir_shows_the_names_and_imports_none() -> None:
    code = "import sys, simmpp; print(*dir(simmpp)); print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, numpy = done.stdout.splitlines()
    assert (names.split(), numpy) == (sorted([*simmpp.__all__, "__version__"]), "False")


def test_version_and_what_there_is_not() -> None:
    assert simmpp.__version__.count(".") == 2
    with pytest.raises(AttributeError, match="module 'simmpp' has no attribute 'trase'"):
        simmpp.trase  # noqa: B018
