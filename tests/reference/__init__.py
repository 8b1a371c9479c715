"""Pictures and numbers held to a reference: formulas, Cycles, and independent tracers."""
