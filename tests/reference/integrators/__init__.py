"""The renderer's ways to indirect light, held to its own path tracer."""
