"""The commands, one file each; :mod:`simmpp.cli` imports the one that is run."""
