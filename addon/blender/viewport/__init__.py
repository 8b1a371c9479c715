"""Rendered viewport shading: what Blender's window shows, rendered by `core.viewport` while Blender
goes on.

The main thread exports what an edit changed, says where the camera is, and draws the latest
picture; everything else is done on a thread per viewport. Nothing of Blender is touched outside of
Blender's own calls.
"""

from __future__ import annotations

from .live import Live, close_all, live_of, register, unregister

__all__ = ["Live", "close_all", "live_of", "register", "unregister"]
