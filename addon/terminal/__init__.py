"""Runs without a window: the command line and the demo."""
