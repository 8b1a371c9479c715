"""The engine as Blender sees it: registration, properties, panels, renders and viewports."""
