"""Readers of mesh files, one a format: ``nodes(data, file)`` gives the meshes that its bytes hold."""
