"""How a result is shown: the surface, its colors and its materials."""
