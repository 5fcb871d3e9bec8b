"""Configurations and the points that they ask for."""
