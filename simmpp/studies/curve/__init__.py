"""Whole curves along x from few runs."""
