"""Samples that move: keyframes for a hand that was put on its product. Knows no fit and no picture."""
