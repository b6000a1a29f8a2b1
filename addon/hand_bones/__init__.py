"""Bones of a hand: which plays which part, how they point, bend and are posed."""
