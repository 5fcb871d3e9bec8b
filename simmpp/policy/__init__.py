"""Policies: a send rule and an ask rule each."""
