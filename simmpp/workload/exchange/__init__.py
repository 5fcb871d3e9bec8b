"""Workloads of other programs, as tables."""
