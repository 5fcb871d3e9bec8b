"""Plain YAML with lines; everything else is refused in one line."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import ConfigError
from simmpp.common.yamlfile import parse_yaml, read_yaml, written


def test_scalars_follow_yaml_1_2() -> None:
    text = "[1e-6, on, 12:30, 0.1, -3, true, null, '7', 010, 2001-01-01, .5, yes, 1_000]"
    assert parse_yaml(text).data == [
        1e-6,
        "on",
        "12:30",
        0.1,
        -3,
        True,
        None,
        "7",
        10,
        "2001-01-01",
        0.5,
        "yes",
        "1_000",
    ]


def test_an_old_yaml_directive_changes_nothing() -> None:
    assert parse_yaml("%YAML 1.1\n---\na: on\nb: 12:30\n").data == {"a": "on", "b": "12:30"}


def test_infinity_and_nan_are_numbers() -> None:
    low, nan = parse_yaml("[-.inf, .NaN]").data  # type: ignore[misc]
    assert low == -math.inf
    assert math.isnan(nan)


def test_lines_of_keys_and_entries() -> None:
    document = parse_yaml("a:\n  b: 1\n  c: [2,\n      3]\n")
    assert document.data == {"a": {"b": 1, "c": [2, 3]}}
    assert document.lines[("a", "b")] == 2
    assert document.lines[("a", "c", 1)] == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\na: 2", "f:2: duplicate key 'a', first on line 1"),
        ("a:\n\t- b", "f:2: broken YAML: found character '\\t' that cannot start any token"),
        ("a: b: c", "f:1: broken YAML: mapping values are not allowed here"),
        ("a: &x 1", "f:1: anchors and aliases (&name, *name) are not supported"),
        ("a: !!python/object:os.system x", "f:1: tags are not supported"),
        ("? [a]\n: b", "f:1: expected a plain key"),
        ("---\na: 1\n---\nb: 2", "f:3: expected one document"),
        ("[" * 100_000, "f:1: nested more than 20 deep"),
        ("a: \x00", "f: broken YAML: unacceptable character"),
        ('a: "\\U99999999"', "f: broken YAML: unreadable"),
        ("x" * 1_000_001, "f: expected at most 1000000 characters"),
    ],
)
def test_refused(text: str, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_yaml(text, "f")
    assert str(caught.value).startswith(message)
    assert len(str(caught.value).splitlines()) == 1


def test_a_bomb_of_aliases_is_refused_at_once() -> None:
    levels = "\n".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 30))
    with pytest.raises(ConfigError, match="anchors and aliases"):
        parse_yaml("a0: &a0 lol\n" + levels)


def test_unreadable_files(tmp_path: Path) -> None:
    (tmp_path / "latin").write_bytes(b"scene: \xe9")
    for path, message in [
        (tmp_path / "none.yaml", "none.yaml: can't read the file: No such file or directory"),
        (tmp_path, ": can't read the file: Is a directory"),
        (tmp_path / "latin", "latin: expected UTF-8 text"),
    ]:
        with pytest.raises(ConfigError) as caught:
            read_yaml(path)
        assert str(caught.value).endswith(message)


@given(st.text("ab:1 \n\t-[]{}?,&*!|>'\"%@`#.~\\x0\u2028\x85", max_size=30))
def test_any_text_is_read_or_refused_in_one_line(text: str) -> None:
    try:
        parse_yaml(text)
    except ConfigError as error:
        assert len(str(error).splitlines()) == 1


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"cells": 8}, "{cells: 8}"),
        ({"a": [1, 2.5, True]}, "{a: [1, 2.5, true]}"),
        (False, "false"),
        (None, "null"),
        ("10 us", "10 us"),
    ],
)
def test_values_are_written_as_they_are_read(value: object, text: str) -> None:
    assert written(value) == text
    assert parse_yaml(text).data == value
