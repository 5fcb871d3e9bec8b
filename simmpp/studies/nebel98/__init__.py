"""Figures and claims of Nebel 1998."""
