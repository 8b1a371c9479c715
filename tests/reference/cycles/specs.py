"""Node trees as plain dicts, so that a case travels as JSON."""

from __future__ import annotations

from typing import Any

Spec = dict[str, Any]


def node(
    kind: str, output: int | str = 0, modes: dict[str, Any] | None = None, **inputs: Any
) -> Spec:
    """The node ShaderNode`kind`. inputs: socket names with `_` for spaces (or i0, i1, ... by index)
    and their values or nodes.

    modes: properties of the node; output: which of its outputs is used.
    """
    return {
        "kind": kind,
        "output": output,
        "modes": modes or {},
        "inputs": {key.replace("_", " "): value for key, value in inputs.items()},
    }
