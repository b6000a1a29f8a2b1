"""A hand's Subdivision level: the surface that Blender makes of the hand's vertices, computed where it is needed."""
