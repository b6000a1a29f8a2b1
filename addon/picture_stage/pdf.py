"""Writes a page as PDF 1.4 of one page, A4 wide: text stays text, pictures stay lossless. No library of Blender's does.

Text is set in Helvetica, which every reader has; text with letters that it lacks is laid down as a picture.
"""

import zlib

import numpy as np

from . import page as pages

WIDTH_PT = 595.28
"""Width of A4, points."""
_WIDTHS = (
    "278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 278 278 "
    "584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778 667 778 722 667 611 722 667 944 "
    "667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 556 333 500 "
    "278 556 500 722 500 500 500 334 260 334 584"
)
"""Widths of the letters from blank to tilde in Helvetica, thousandths of its size (Adobe Core 14 AFM)."""
_LETTERS = dict(zip(range(32, 127), map(int, _WIDTHS.split()), strict=True)) | {0xB2: 333, 0xB7: 278, 0xB0: 400}
_OTHER = 556
_CORE = "cp1252"


def save(path, page):
    """Write the page to `path`."""
    path.write_bytes(written(page))


def written(page):
    """The page as the bytes of a PDF."""
    drawing, images = _drawing(page)
    height = WIDTH_PT * page.height / page.width
    names = " ".join(f"/I{number} {5 + number} 0 R" for number in range(len(images)))
    font = b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>"
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        (
            f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {WIDTH_PT:.2f} {height:.2f}] /Contents 4 0 R "
            f"/Resources << /Font << /F {5 + len(images)} 0 R >> /XObject << {names} >> >> >>"
        ).encode(),
        _stream(b"", zlib.compress(drawing.encode(_CORE), 9)),
        *(_image(pixels) for pixels in images),
        font,
    ]
    return _file(objects)


def _file(objects):
    out, places = bytearray(b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n"), []
    for number, content in enumerate(objects, 1):
        places.append(len(out))
        out += b"%d 0 obj\n" % number + content + b"\nendobj\n"
    start = len(out)
    out += b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    for place in places:
        out += b"%010d 00000 n \n" % place
    out += b"trailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(objects) + 1, start)
    return bytes(out)


def _stream(entries, data):
    return b"<< %s /Filter /FlateDecode /Length %d >>\nstream\n" % (entries, len(data)) + data + b"\nendstream"


def _image(pixels):
    """An image object, rows from above, each row as differences to the left, which compress well."""
    rows = np.round(np.clip(pixels, 0.0, 1.0) * 255.0).astype(np.uint8)[::-1]
    height, width = rows.shape[:2]
    lines = np.empty((height, 1 + 3 * width), np.uint8)
    lines[:, 0] = 1
    lines[:, 1:4] = rows[:, 0]
    lines[:, 4:] = np.diff(rows, axis=1).reshape(height, -1)
    entries = (
        f"/Type /XObject /Subtype /Image /Width {width} /Height {height} /ColorSpace /DeviceRGB /BitsPerComponent 8 "
        f"/DecodeParms << /Predictor 15 /Colors 3 /BitsPerComponent 8 /Columns {width} >>"
    )
    return _stream(entries.encode(), zlib.compress(lines.tobytes(), 9))


def _drawing(page):
    """The page's operators, and the pixels of its pictures in the order of their numbers."""
    scale, images = WIDTH_PT / page.width, []
    lines = [f"{scale:.6f} 0 0 {scale:.6f} 0 0 cm", _filled((0.0, 0.0, page.width, page.height), page.color)]
    for item in page.items:
        if isinstance(item, pages.Box):
            lines.append(_filled(item.box, item.color))
        elif isinstance(item, pages.Picture):
            lines.append(_laid(item.box, len(images)))
            images.append(item.pixels)
        elif _is_core(item.text):
            lines.append(_set(item))
        else:
            box, pixels = _as_picture(item, page.color)
            lines.append(_laid(box, len(images)))
            images.append(pixels)
    return "\n".join(lines), images


def _filled(box, color):
    return "{:.4f} {:.4f} {:.4f} rg {:.2f} {:.2f} {:.2f} {:.2f} re f".format(*color, *box)


def _laid(box, number):
    x, y, width, height = box
    return f"q {width:.2f} 0 0 {height:.2f} {x:.2f} {y:.2f} cm /I{number} Do Q"


def _set(item):
    x = item.place[0] - pages.share_left(item.align) * _width(item.text, item.size)
    text = item.text.replace("\\", r"\\").replace("(", r"\(").replace(")", r"\)")
    color = "{:.4f} {:.4f} {:.4f} rg".format(*item.color)
    return f"BT {color} /F {item.size:.2f} Tf {x:.2f} {item.place[1]:.2f} Td ({text}) Tj ET"


def _width(text, size):
    return sum(_LETTERS.get(ord(letter), _OTHER) for letter in text) * size / 1000.0


def _is_core(text):
    return all(letter.isprintable() and letter.encode(_CORE, "ignore") for letter in text)


def _as_picture(item, color):
    """Box and pixels of a line of text, three pixels to a unit."""
    width, below = pages.width_of(item.text, item.size) + 4.0, 0.4 * item.size
    sheet = pages.Page(width, below + 1.2 * item.size, color)
    sheet.text((2.0, below), item.size, item.text, item.color)
    x = item.place[0] - pages.share_left(item.align) * (width - 4.0) - 2.0
    return (x, item.place[1] - below, width, sheet.height), pages.painted(sheet, 3.0)
