# SPDX-License-Identifier: Apache-2.0
"""Reads flight recordings according to drivers/flight/format.md, without the project's code."""
import struct
import zlib

HEADER, DATA, END = 1, 2, 3
BYTES, CAN = 1, 2


def blocks(content):
    """(type, payload) of each block of a closed file; ValueError if a byte contradicts the format."""
    coding, size = content[5], struct.unpack_from("<I", content, 8)[0]
    first = content[16:16 + size]
    number = struct.unpack_from("<Q", zlib.decompress(first) if coding == 1 else first)[0]
    at = 0
    while at < len(content):
        magic, kind, coding, short, packed, unpacked = struct.unpack_from("<4sBBHII", content, at)
        place = struct.pack("<QQ", number, at) if kind != HEADER else bytes(16)
        head, payload = content[at:at + 16], content[at + 16:at + 16 + packed]
        if magic != b"\xf1IFR" or short != zlib.crc32(place + head[:6] + head[8:]) & 0xFFFF:
            raise ValueError(f"no block at byte {at}: {head.hex()}")
        if struct.unpack_from("<I", content, at + 16 + packed)[0] != zlib.crc32(place + head + payload):
            raise ValueError(f"the block at byte {at} is damaged")
        payload = zlib.decompress(payload) if coding == 1 else payload
        if len(payload) != unpacked:
            raise ValueError(f"the block at byte {at} unpacks to {len(payload)} bytes, it says {unpacked}")
        yield kind, payload
        at += 20 + packed


def deliveries(content):
    """(time in ns, kind, payload) of the sensor's data in order; ValueError if the file is damaged."""
    counted = ended = 0
    for kind, payload in blocks(content):
        if kind == END:
            ended = struct.unpack_from("<Q", payload)[0]
        at = 0
        while kind == DATA and at < len(payload):
            what, _, _, size, time_ns = struct.unpack_from("<BBHIq", payload, at)
            if what in (BYTES, CAN) and size > 0:
                yield time_ns, what, payload[at + 16:at + 16 + size]
            at += 16 + size
            counted += 1
    if counted != ended:
        raise ValueError(f"{counted} entries in a file that says {ended}")


def rewritten(content, change):
    """The file with change(kind, payload) instead of each block's payload."""
    out, number = b"", None
    for kind, payload in blocks(content):
        number = struct.unpack_from("<Q", payload)[0] if kind == HEADER else number
        payload = change(kind, payload)
        place = struct.pack("<QQ", number, len(out)) if kind != HEADER else bytes(16)
        begin, end = struct.pack("<4sBB", b"\xf1IFR", kind, 0), struct.pack("<II", len(payload), len(payload))
        head = begin + struct.pack("<H", zlib.crc32(place + begin + end) & 0xFFFF) + end
        out += head + payload + struct.pack("<I", zlib.crc32(place + head + payload))
    return out


def shifted(content, by_ns):
    """The file as if its arrival clock and wall clock had been set by this offset."""
    def shift(kind, payload):
        at, moved = 0, bytearray(payload)
        while kind == DATA and at < len(payload):
            _, _, _, size, time_ns = struct.unpack_from("<BBHIq", payload, at)
            if time_ns > 0:
                struct.pack_into("<q", moved, at + 8, time_ns + by_ns)
            at += 16 + size
        return bytes(moved)
    return rewritten(content, shift)


def with_header(content, edit):
    """The file with edit(text) instead of its header's text, with the same number and version."""
    return rewritten(content, lambda kind, payload: payload[:10] + edit(payload[10:]) if kind == HEADER else payload)


def frame_text(payload):
    """A recorded CAN frame in candump's format."""
    can_id, flags, length = struct.unpack_from("<IBB", payload)
    data = payload[6:6 + length].hex().upper()
    name = f"{can_id:08X}" if flags & 1 else f"{can_id:03X}"
    # FD frames have a second # and their flags (bit rate switch).
    return f"{name}##{1 if flags & 4 else 0}{data}" if flags & 2 else f"{name}#{data}"
