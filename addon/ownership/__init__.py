"""What in a scene is Thenar's own, and the scene without it."""
