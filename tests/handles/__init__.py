"""Handles, grasps and random postures that a press has to hold on, and a measure made apart from the library."""
