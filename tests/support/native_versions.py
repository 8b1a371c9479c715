"""The native module as another version of the engine would have it."""

from __future__ import annotations


def file_name(version: str) -> str:
    """Without its suffix."""
    return f"photon_splat_native_{version.replace('.', '_')}"


def relabelled(module: bytes, here: str, there: str) -> bytes:
    """The file of the module of version `here`, that says it is of version `there`: as its own
    text, and in the name that keeps its types from those of other versions. Both have the same
    length.
    """
    assert len(here) == len(there)
    for old, new in (
        (f"{here}\0", f"{there}\0"),
        (file_name(here), file_name(there)),
    ):
        assert old.encode() in module, old
        module = module.replace(old.encode(), new.encode())
    return module
