"""The objects that are the product: parts, copies that carry pressure, and where it was moved to."""
