"""Soft grips on products: their settings, and which vertices of the product they cover."""
