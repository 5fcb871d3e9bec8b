"""The arrays of a run: one layout, views, hash tables."""
