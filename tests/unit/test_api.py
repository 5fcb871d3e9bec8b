"""``import simmpp``: each name is where it is said to be, and is imported when it is first used."""

from __future__ import annotations

import ast
import inspect
import pydoc
import re
import runpy
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

import simmpp
from simmpp.common.documented import fields_below
from simmpp.common.errors import InputError

GUIDE = Path(simmpp.__file__).with_name("README.md")
TABLE = GUIDE.read_text(encoding="utf-8").partition("## From Python")[2].partition("\n## ")[0]
EXAMPLES = dict(re.findall(r"^\| `(\w+)` \|.*\| `(.*)` \|$", TABLE, re.MULTILINE))
FUNCTIONS = [name for name in simmpp.__all__ if inspect.isfunction(getattr(simmpp, name))]
WRONG: tuple[Any, ...] = (-1.5, "no such thing", [None], frozenset())


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


# --- the guide and the help ---


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the guide's examples leave behind, run one after the other in an empty folder."""
    made: dict[str, Any] = {"simmpp": simmpp}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("examples"))
        for example in EXAMPLES.values():
            exec(example, made)
        assert Path("eager.png").read_bytes().startswith(b"\x89PNG")
    return made


def test_the_guide_has_an_example_of_each_name_and_they_run(names: dict[str, Any]) -> None:
    assert sorted(EXAMPLES) == sorted(simmpp.__all__)
    assert all(f"simmpp.{name}(" in EXAMPLES[name] for name in FUNCTIONS)
    assert names["again"].n_rays == names["workload"].n_rays
    assert list(names["gains"]) == ["object", "ray", "eager"]
    assert [(e.policy, str(e.fraction)) for e in names["curve"]] == [
        *(("ray", "1/10"), ("ray", "1/2")),
        *(("eager", "1/10"), ("eager", "1/2")),
    ]
    assert len(names["rows"]) == 4 and names["profits"] is names["table"].profits


def public_classes() -> list[type]:
    """Those that can be named, and those that calls give."""
    things = [getattr(simmpp, name) for name in simmpp.__all__]
    classes = [thing for thing in things if inspect.isclass(thing)]
    for function in (thing for thing in things if inspect.isfunction(thing)):
        given = get_type_hints(function, localns={"pandas": Any}).get("return")
        classes += [cls for cls in (given, *get_args(given)) if inspect.isclass(cls)]
    return sorted(
        {c for c in classes if c.__module__.startswith("simmpp")}, key=lambda c: c.__name__
    )


@pytest.mark.parametrize("cls", public_classes(), ids=lambda cls: cls.__name__)
def test_help_explains_each_field(cls: type) -> None:
    fields = list(fields_below(cls))
    text = pydoc.render_doc(cls, renderer=pydoc.plaintext)
    assert {name for name, _, _ in fields} >= {
        f for f in vars(cls)["__annotations__"] if f[0] != "_"
    }
    for name, _, meaning in fields:
        assert meaning, f"{cls.__name__}.{name} has no text"
        assert f" {name} : " in text
        assert all(line.strip() in text for line in meaning.splitlines())


def test_help_lists_the_names() -> None:
    text = pydoc.render_doc(simmpp, renderer=pydoc.plaintext)
    assert all(f"{name}(" in text or f"class {name}" in text for name in simmpp.__all__)


# --- types and mistakes ---


def test_the_script_that_type_checkers_see_runs() -> None:
    script = runpy.run_path(str(Path(__file__).with_name("script_of_a_user.py")))
    results = script["simulated"](4)
    assert [result.policy for result in results] == ["object", "ray", "concurrent"]
    assert len(set(script["taken"]())) == 1
    profits, table = script["given"](results)
    assert profits is table.profits


def arguments(names: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Right ones of each function."""
    kept = {key: names[key] for key in ("workload", "machine", "placement", "memory", "rules")}
    part = {key: kept[key] for key in ("workload", "machine")}
    return {
        "load_scene": {"spec": "tetra:1"},
        "trace": {"scene": names["scene"], "picture": names["picture"]},
        "export_workload": {"workload": kept["workload"], "path": "rays.npz"},
        "import_workload": {"path": "rays.npz"},
        "make_machine": {"preset": "t3e", "overrides": {}, "processors": 8, "shape": (2, 2, 2)},
        "place": {k: kept[k] for k in ("workload", "memory", "rules")}
        | {"processors": 8, "seed": 0},
        "simulate": part
        | {"placement": names["placement"], "policy": "ray"}
        | {"engine": "compiled", "ready_order": "depth-first", "record": None},
        "profits": {"results": names["results"], "reference": "object"},
        "estimate": part
        | {"policies": ["ray"], "fractions": [0.5], "rules": kept["rules"], "engine": "compiled"}
        | {"ready_order": "depth-first", "replicates": 1, "seed": 0},
        "advise": {"config": {"scene": "tetra:1"}, "workers": 1, "seconds": 1.0},
        "sweep": {"config": {"scene": "tetra:1"}, "workers": 1, "engine": "compiled"}
        | {"timeout_s": 1.0, "out": None},
    }


@pytest.mark.parametrize("function", FUNCTIONS)
def test_a_wrong_argument_is_named_in_one_line(
    function: str, names: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    right = arguments(names)[function]
    for name in right:
        for value in WRONG:
            if (name, value) == FINE:
                continue
            with pytest.raises(InputError) as caught:
                getattr(simmpp, function)(**(right | {name: value}))
            problem = str(caught.value)
            called = (name, CALLED.get(name), value, f"no scene {value!r}")
            is_named = problem.startswith(tuple(f"{word}: " for word in called))
            assert is_named and "\n" not in problem, (name, value, problem)


FINE = ("out", "no such thing")
CALLED = {"spec": "scene", "fractions": "curve", "replicates": "curve"}
"""How errors name an argument that a configuration calls otherwise, or that is one of several."""


@pytest.mark.parametrize(
    "cls", ["Cells", "Memory", "Picture", "PlacementRules", "PolicyParameters"]
)
def test_a_wrong_field_is_named_in_one_line(cls: str) -> None:
    for name in inspect.signature(getattr(simmpp, cls)).parameters:
        for value in (-1.5, [None], frozenset()):
            with pytest.raises(InputError) as caught:
                getattr(simmpp, cls)(**{name: value})
            assert str(caught.value).startswith(f"{name}: value ")
            assert "\n" not in str(caught.value)
