"""The native module: how it is found, and how it gets a scene."""
