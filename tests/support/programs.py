"""Shader programs of one closure with constant inputs, written without Blender."""

from __future__ import annotations

from typing import Any

import numpy as np
from photon_splat.core.native.library import load
from photon_splat.core.scene.shading import Feature, Program

UNUSED = {"F": 0x7FFFFFFF, "V": 0x7FFFFFFF, "t": 0xFFFFFFFF, "a": 0xFFFFFFFF}
CONSTANT = 1 << 31
FEATURES = {
    "Diffuse": Feature.GATHERS | Feature.REST,
    "Translucent": Feature.GATHERS,
    "Transparent": Feature.TRANSPARENT,
    "Emission": Feature.EMITS | Feature.CONSTANT_EMISSION,
    "Principled": Feature.GATHERS
    | Feature.REST
    | Feature.SHARP
    | Feature.TRANSPARENT
    | Feature.EMITS,
}


def closure(operation: str, **inputs: Any) -> Program:
    """A program that adds one closure of weight 1; inputs by the names of ops.def, those not given
    are 0 or the first mode.
    """
    operations = load().shader_operations()
    opcode, operands = operations[operation]
    code, constants = [opcode], []
    unknown = inputs.keys() - {name for _, name, _ in operands}
    assert not unknown, f"{operation} has no {unknown}"
    for kind, name, modes in operands:
        value = inputs.get(name, 1.0 if name == "weight" else None)
        if kind in ("f", "v"):
            code.append(CONSTANT | len(constants))
            constants += np.broadcast_to(
                0.0 if value is None else value, (3 if kind == "v" else 1,)
            ).tolist()
        elif kind == "m":
            code.append(modes.index(value) if value is not None else 0)
        else:
            code.append(UNUSED.get(kind, 0))
    code.append(operations["End"][0])
    features = FEATURES.get(operation, Feature.REST | Feature.SHARP)
    return Program(
        operation, np.array(code, np.uint32), np.array(constants, np.float32), 4, features
    )
