# SPDX-License-Identifier: Apache-2.0
"""Reads logs of lcm-logger according to their description, without the project's code."""
import struct

SYNC = 0xEDA1DA01


def read_log(path):
    """(channel, µs, data) of each event."""
    with open(path, "rb") as file:
        content = file.read()
    at, events = 0, []
    while at < len(content):
        sync, _, utime, channel, data = struct.unpack_from(">IqqII", content, at)
        assert sync == SYNC, at
        at += 28
        events.append((content[at:at + channel].decode(), utime, content[at + channel:at + channel + data]))
        at += channel + data
    return events


def write_log(path, events):
    with open(path, "wb") as file:
        for number, (channel, utime, data) in enumerate(events):
            file.write(struct.pack(">IqqII", SYNC, number, utime, len(channel), len(data)) + channel.encode() + data)
