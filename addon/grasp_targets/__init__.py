"""Forces by finger, or a recording, as what a hand shall reach from where it is. Registered from `operators`."""
