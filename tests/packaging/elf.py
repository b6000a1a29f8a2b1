"""Reads from an ELF file, without tools, which libraries it needs and which symbol versions of them."""

import struct

# Section types and the tag of a needed library, as in the ELF specification and its GNU extension.
SHT_DYNAMIC, SHT_GNU_VERNEED = 6, 0x6FFFFFFE
DT_NEEDED = 1


def needed(data):
    """Library names and `{library: {versions}}` of a 64-bit little-endian ELF file."""
    if data[:6] != b"\x7fELF\x02\x01":
        raise ValueError("not a 64-bit little-endian ELF file")
    sections = _sections(data)
    libraries, versions = [], {}
    for kind, offset, size, link, entries in sections:
        strings = sections[link][1] if link < len(sections) else 0
        if kind == SHT_DYNAMIC:
            pairs = struct.iter_unpack("<qQ", data[offset : offset + size])
            libraries += [_text(data, strings + value) for tag, value in pairs if tag == DT_NEEDED]
        elif kind == SHT_GNU_VERNEED:
            versions = _version_needs(data, offset, entries, strings)
    return libraries, versions


def _sections(data):
    """Type, offset, size, link and info of every section."""
    start = struct.unpack_from("<Q", data, 0x28)[0]
    size, count = struct.unpack_from("<HH", data, 0x3A)
    headers = (struct.unpack_from("<IIQQQQIIQQ", data, start + i * size) for i in range(count))
    return [(kind, offset, length, link, info) for _, kind, _, _, offset, length, link, info, _, _ in headers]


def _version_needs(data, offset, count, strings):
    found = {}
    for _ in range(count):
        _, names, file, auxiliary, following = struct.unpack_from("<HHIII", data, offset)
        versions = found.setdefault(_text(data, strings + file), set())
        place = offset + auxiliary
        for _ in range(names):
            _, _, _, name, step = struct.unpack_from("<IHHII", data, place)
            versions.add(_text(data, strings + name))
            place += step
        offset += following
    return found


def _text(data, offset):
    return data[offset : data.index(b"\0", offset)].decode()
