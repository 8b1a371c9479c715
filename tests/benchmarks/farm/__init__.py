"""How a picture in parts scales."""
