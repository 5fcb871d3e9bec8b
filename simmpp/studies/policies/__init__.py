"""Policies of one's own: a file to begin with, and what every policy has to keep."""
