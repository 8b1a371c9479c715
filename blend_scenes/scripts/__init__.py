"""The scripts that make the scenes: `python -m blend_scenes.scripts.make_all`."""
