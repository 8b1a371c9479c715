"""Jobs for render farms that exist: what is to run where, and in which order. Knows no Blender."""

from __future__ import annotations

from .bundle import write_bundle
from .job import Animation, FarmError, Job, Still, System

__all__ = ["Animation", "FarmError", "Job", "Still", "System", "write_bundle"]
