"""Regression of profit curves in continuous integration."""
