"""Blender objects to arrays in millimetres and back. Knows nothing of the native module."""
