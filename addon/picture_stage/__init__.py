"""Stage and page of pictures: what is shown, light, true colors of the map, text, and PDF. Knows no buttons."""
