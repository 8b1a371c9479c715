"""Other renderers in the charts, where they are installed (`make setup-rivals`): nothing else needs
them.

This package is read by two Pythons: ours, which exports the scene, and that of the rivals, which
has no Blender.
"""

from __future__ import annotations

from types import ModuleType

from tests.benchmarks.chart.rivals import luxcore, mitsuba3

RIVALS = (*mitsuba3.INTEGRATORS, *luxcore.METHODS)


def of(method: str) -> ModuleType:
    """The module with describe(), render() and version()."""
    return mitsuba3 if method in mitsuba3.INTEGRATORS else luxcore
