"""Draws what the scene already holds. Knows nothing of the workflow and the native module."""
