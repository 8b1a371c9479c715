"""Scenes, settings and machines at the edge of sense."""
