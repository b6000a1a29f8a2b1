"""Hands that others rigged: bones recognised, shown and corrected, regions and poses read. Registration only."""
