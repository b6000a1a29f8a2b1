"""The grasps found as choices: a picture of each, its score, why it ranks lower. Registered from `more`."""
