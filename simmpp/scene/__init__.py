"""Scenes: objects, materials, lights, cameras, and where they come from."""
