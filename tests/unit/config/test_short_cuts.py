"""Options in place of --set: the same settings, and mistakes told by the option's name."""

from __future__ import annotations

from fractions import Fraction

import pytest

from simmpp.common.errors import ConfigError
from simmpp.config.config import Config, config_from_mapping
from simmpp.config.overrides import Override
from simmpp.config.short_cut import ShortCut

TETRA = {"scene": "tetra:2"}
RUN = {
    "--policy": ShortCut("--policy", "policy", ("ray,concurrent", "object")),
    "--processors": ShortCut("--processors", "processors", ("8",)),
    "--fraction": ShortCut("--fraction", "memory.fraction", ("5%",)),
    "--seed": ShortCut("--seed", "seeds", ("3",)),
}
SWEEP = {name: cut._replace(is_swept=True) for name, cut in RUN.items()}


def made(*overrides: Override, **data: object) -> Config:
    return config_from_mapping(TETRA | data, overrides)


def refused(*overrides: Override, **data: object) -> str:
    with pytest.raises(ConfigError) as raised:
        made(*overrides, **data)
    return str(raised.value)


@pytest.mark.parametrize(
    ("option", "assignment"),
    [
        ("--policy", "policy=[ray, concurrent, object]"),
        ("--processors", "processors=8"),
        ("--fraction", "memory.fraction=5%"),
        ("--seed", "seeds=[3]"),
    ],
)
def test_an_option_is_set_by_another_name(option: str, assignment: str) -> None:
    sweep = {"processors": [1, 2]}  # which a run leaves alone
    assert made(RUN[option], sweep=sweep).settings == made(assignment, sweep=sweep).settings


def test_a_sweep_makes_axes_of_them() -> None:
    cut = ShortCut("--fraction", "memory.fraction", ("5%,1/64", "0.5"), is_swept=True)
    config = made(SWEEP["--processors"], cut, sweep={"processors": [1, 2]})
    assert config.settings.sweep == {"processors": [8], "memory.fraction": ["5%", "1/64", 0.5]}


def test_memory_in_bytes_gives_way() -> None:
    config = made(RUN["--fraction"], memory={"bytes": "1 MB"})
    assert (config.memory.bytes, config.memory.fraction) == (None, Fraction(1, 20))


def test_policies_are_a_list_or_the_axis_that_there_is() -> None:
    assert len(made(SWEEP["--policy"]).settings.policy) == 3
    config = made(SWEEP["--policy"], sweep={"policy": ["ray"]})
    assert config.settings.sweep == {"policy": ["ray", "concurrent", "object"]}


@pytest.mark.parametrize(
    ("texts", "seeds"),
    [(("3",), (0, 1, 2)), (("1",), (0,)), (("0,5",), (0, 5)), (("7", "9"), (7, 9))],
)
def test_seeds_are_counted_or_named(texts: tuple[str, ...], seeds: tuple[int, ...]) -> None:
    assert made(ShortCut("--seeds", "seeds", texts, is_swept=True)).settings.seeds == seeds


@pytest.mark.parametrize(
    ("cut", "problem"),
    [
        (RUN["--processors"]._replace(texts=("0",)), "value 0: expected an integer from 1 to "),
        (SWEEP["--processors"]._replace(texts=("8,x",)), "value 'x': expected an integer from"),
        (RUN["--fraction"]._replace(texts=("2",)), "value 2: expected a share from 0 to 1"),
        (SWEEP["--fraction"]._replace(texts=("2%,3",)), "value 3: expected a share from 0 to"),
        (RUN["--policy"]._replace(texts=("rey",)), "value 'rey': expected object, ray, concurr"),
        (RUN["--policy"]._replace(texts=("ray,ray",)), "two are called 'ray': expected a label"),
        (RUN["--policy"]._replace(texts=("{name: ray, x: 1}",)), "unknown key 'x': expected one"),
        (RUN["--seed"]._replace(texts=("1", "2")), "value '1, 2': expected one, as one point is "),
        (RUN["--processors"]._replace(texts=("1,2",)), "value '1,2': expected one, as one point"),
        (
            ShortCut("--seeds", "seeds", ("0",), is_swept=True),
            "value 0: expected how many, 1 to 100000, or which, such as 0,5",
        ),
        (ShortCut("--seeds", "seeds", ("1,x",), is_swept=True), "value 'x' in the list: expected"),
        (RUN["--processors"]._replace(texts=("",)), "value '': expected at least one value"),
        (RUN["--processors"]._replace(texts=("]",)), "broken YAML: "),
    ],
)
def test_mistakes_name_the_option(cut: ShortCut, problem: str) -> None:
    assert refused(cut).startswith(f"{cut.option}: {problem}")


@pytest.mark.parametrize(
    ("option", "key"),
    [
        ("--policy", "policy.batch"),
        ("--processors", "processors"),
        ("--processors", "sweep.processors,memory.fraction"),
        ("--fraction", "memory"),
        ("--fraction", "memory.bytes"),
        ("--fraction", "sweep.memory.fraction"),
        ("--seed", "seeds"),
    ],
)
def test_an_option_and_its_key_are_too_much(option: str, key: str) -> None:
    assert refused(RUN[option], f"{key}=1") == f"expected {option} or --set {key}, got both"


def test_linked_axes_are_not_swept_twice() -> None:
    linked = {"processors, memory.fraction": [[4, 0.5], [8, 0.1]]}
    assert "processors is swept twice" in refused(SWEEP["--processors"], sweep=linked)
