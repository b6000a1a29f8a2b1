"""How the made hand looks: skin, nails, materials, light and camera."""
