"""Profits and pictures from rows."""
