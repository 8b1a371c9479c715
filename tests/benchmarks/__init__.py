"""Measurements and charts; make help names the commands."""
