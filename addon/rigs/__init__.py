"""Which bones are a hand, found by hierarchy and shape. Knows nothing of Blender."""
