"""Measures Cycles, for tables of the engine and for questions about it."""
