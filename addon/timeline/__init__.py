"""A contact over the frames of a scene: baked, and followed by skin that remembers."""
