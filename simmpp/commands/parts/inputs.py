"""What a command that needs no machine is given: a configuration, or a scene alone."""

from __future__ import annotations

from collections.abc import Sequence

from simmpp.commands.parts.own_policies import tell_files
from simmpp.config.config import Config, config_from_mapping, load_config


def config_of(spec: str, overrides: Sequence[str], *, may_run: bool) -> Config:
    """The configuration of that name (.yaml), or one of the scene that ``spec`` names."""
    if spec.lower().endswith((".yaml", ".yml")):
        config = load_config(spec, overrides, may_run=may_run)
        tell_files(config)
        return config
    return config_from_mapping({"scene": spec}, overrides)
