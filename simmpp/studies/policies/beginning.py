"""What ``simmpp policy new`` writes: a policy that runs, with comments on what one changes."""

from __future__ import annotations

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown
from simmpp.policy.parameters import POLICIES

_TEXT = '''"""{name}: what it decides, and why."""

from simmpp.policy import Policy, hook

# A hook gets the view v of the PE that decides: whole numbers, times in picoseconds. Some of them:
#   v.load, v.ready       rays that this PE holds; those that could go on at once
#   v.known_load          load last heard of the PE asked about, v.age_ps: how long ago
#   v.waiting, v.unasked  rays that wait; of them, those that no request is on its way for
#   v.nothing_else        1 if this PE has nothing else to do
#   v.min_load            what the configuration says, as rays
#   v.memory[0] to [7]    yours to write, of this PE, 0 at the start
#   v.random              a new random number from 0 to 2**63 - 1
#   v.patience            your own numbers, declared below, set in the configuration
# `simmpp policy view` lists all of them. A policy may also have the hooks keep (what fetched
# objects are worth), heard and idle (messages of its own, times to be woken at): see the package's
# policy/README.md.


@hook
def send(v):
    """How many of the rays that wait may go to PE v.other now? 0 none, v.waiting all."""
    if v.load <= v.min_load or v.load <= v.known_load:
        return 0
    return (v.load - v.known_load) // 2


@hook
def ask(v):
    """May object v.object be asked for now? 0 no, 1 yes, 2 + k: PE k, if that has it."""
    return v.nothing_else or v.unasked >= v.patience


POLICY = Policy(
    "{name}",
    send=send,
    ask=ask,
    batch="batch",  # send is asked when that many rays wait for one PE, or with nothing else to do
    like="concurrent",  # packs messages as that does
    parameters={{"patience": 8}},
)
'''


def beginning(name: str) -> str:
    """The text of a policy's file.

    Raises ConfigError for a name that is none.
    """
    if not name.isidentifier() or name in POLICIES:
        expected = "a name of letters, digits and _ that is none of the package's policies"
        raise ConfigError(f"value {shown(name)}: expected {expected}")
    return _TEXT.format(name=name)
