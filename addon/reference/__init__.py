"""The reference solve: the hand's tissue as a solid, and the fast result compared with it."""
