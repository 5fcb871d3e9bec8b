"""Readers of mesh files, one a format: ``nodes(data, file)`` gives the meshes in it."""
