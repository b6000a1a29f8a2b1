"""Blender properties: what the user sets and what a result keeps in the file."""
