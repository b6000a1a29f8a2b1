"""One fit of a grasp: where it starts, what it wants to be zero, and how it gets there."""
