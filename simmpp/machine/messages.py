"""The kinds of messages that PEs exchange."""

from __future__ import annotations

REQUEST, OBJECT, RAYS, LOAD, USER, STEAL, DEPOSIT = range(7)
MESSAGE_KINDS = ("request", "object", "rays", "load", "user", "steal", "deposit")
COPIED_KINDS = MESSAGE_KINDS[:USER]
"""Those whose packing and unpacking a machine has constants for."""
USER_COPIED_AS = REQUEST
"""A message of a policy's own is a few words, as a request is, and costs what that does; so does
one that is about stealing."""
USER_WORDS = 4
"""Words of a message of a policy's own."""
WORD_BYTES = 8
DEPOSIT_BYTES = 16
"""Payload of one deposit: an object and what is left in its results. Batches of them are packed as
rays are."""
STEAL_BYTES = 16
"""Payload of an answer to a thief: whose pixels, the first, how many. Its question has none."""
