"""Letters of the legend as pixels, for Blenders that cannot write text into an image (before 4.4)."""

import numpy as np

_GLYPHS = {
    "0": (14, 17, 19, 21, 25, 17, 14),
    "1": (4, 12, 4, 4, 4, 4, 14),
    "2": (14, 17, 1, 2, 4, 8, 31),
    "3": (31, 2, 4, 2, 1, 17, 14),
    "4": (2, 6, 10, 18, 31, 2, 2),
    "5": (31, 16, 30, 1, 1, 17, 14),
    "6": (6, 8, 16, 30, 17, 17, 14),
    "7": (31, 1, 2, 4, 8, 8, 8),
    "8": (14, 17, 17, 14, 17, 17, 14),
    "9": (14, 17, 17, 15, 1, 2, 12),
    ".": (0, 0, 0, 0, 0, 12, 12),
    "+": (0, 4, 4, 31, 4, 4, 0),
    "-": (0, 0, 0, 31, 0, 0, 0),
    "R": (30, 17, 17, 30, 20, 18, 17),
    "P": (30, 17, 17, 30, 16, 16, 16),
    "r": (0, 0, 22, 25, 16, 16, 16),
    "e": (0, 0, 14, 17, 31, 16, 14),
    "s": (0, 0, 14, 16, 14, 1, 30),
    "u": (0, 0, 17, 17, 17, 19, 13),
    "k": (16, 16, 18, 20, 24, 20, 18),
    "a": (0, 0, 14, 1, 15, 17, 15),
    "S": (15, 16, 16, 14, 1, 1, 30),
    "D": (30, 17, 17, 17, 17, 17, 30),
    "T": (31, 4, 4, 4, 4, 4, 4),
    "C": (14, 17, 16, 16, 16, 17, 14),
    "H": (17, 17, 17, 31, 17, 17, 17),
    "N": (17, 25, 21, 19, 17, 17, 17),
    "M": (17, 27, 21, 21, 17, 17, 17),
    "b": (16, 16, 30, 17, 17, 17, 30),
    "c": (0, 0, 14, 16, 16, 17, 14),
    "d": (1, 1, 15, 17, 17, 17, 15),
    "f": (6, 9, 8, 28, 8, 8, 8),
    "g": (0, 15, 17, 17, 15, 1, 14),
    "h": (16, 16, 22, 25, 17, 17, 17),
    "i": (4, 0, 12, 4, 4, 4, 14),
    "l": (12, 4, 4, 4, 4, 4, 14),
    "m": (0, 0, 26, 21, 21, 21, 21),
    "n": (0, 0, 22, 25, 17, 17, 17),
    "o": (0, 0, 14, 17, 17, 17, 14),
    "p": (0, 0, 30, 17, 30, 16, 16),
    "t": (8, 8, 28, 8, 8, 9, 6),
    "v": (0, 0, 17, 17, 17, 10, 4),
    "w": (0, 0, 17, 17, 21, 21, 10),
    "x": (0, 0, 17, 10, 4, 10, 17),
    "y": (0, 0, 17, 17, 15, 1, 14),
    ",": (0, 0, 0, 0, 12, 4, 8),
}
"""Rows from above of each letter, 7 of 5 pixels; the highest bit is the left pixel."""


def ink(texts, width, height):
    """How far text covers each pixel (height, width), rows from below. `texts`: (x, y, size, text)."""
    image = np.zeros((height, width), np.float32)
    for x, y, size, text in texts:
        dot = max(1, round(size / 10))
        for place, letter in enumerate(text):
            stamp = np.kron(glyph(letter)[::-1], np.ones((dot, dot), np.float32))
            _press(image, stamp, round(x) + place * 6 * dot, round(y))
    return image


def glyph(letter):
    """Pixels (7, 5) of a letter, rows from above; empty for one that the legend never writes."""
    rows = np.array(_GLYPHS.get(letter, (0,) * 7))
    return (rows[:, None] >> np.arange(4, -1, -1) & 1).astype(np.float32)


def _press(image, stamp, x, y):
    height, width = image.shape
    rows, columns = stamp.shape
    if x >= 0 and y >= 0 and x + columns <= width and y + rows <= height:
        image[y : y + rows, x : x + columns] = np.maximum(image[y : y + rows, x : x + columns], stamp)
