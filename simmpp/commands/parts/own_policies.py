"""Policies of one's own on the command line: which files are run."""

from __future__ import annotations

from simmpp.commands.parts.terminal import notice
from simmpp.config.axes import keys_of
from simmpp.config.config import Config, point_at
from simmpp.policy.file import PolicyFile


def tell_files(config: Config) -> None:
    """Say which files of policies a configuration runs."""
    for file in dict.fromkeys(_files(config)):
        notice(f"policy: runs {file.where} (sha256 {file.digest[:12]})")


def _files(config: Config) -> list[PolicyFile]:
    axes = config.axes
    first = dict.fromkeys(axes, 0)
    swept = [name for name, axis in axes.items() if any("policy" in key for key in keys_of(axis))]
    points = [{**first, name: n} for name in swept for n in range(len(axes[name]))]
    configs = [config, *(point_at(config, axes, numbers) for numbers in points)]
    policies = [policy for each in configs for policy in each.settings.policy]
    return [policy.file for policy in policies if isinstance(policy.file, PolicyFile)]
