"""Policies: how many rays may be sent where, may an object be asked for, and of whom?

A policy of one's own is a file that imports ``Policy`` and ``hook`` from here.
"""

from simmpp.policy.policy import Policy, hook

__all__ = ["Policy", "hook"]
