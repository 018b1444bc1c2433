#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints of one sensor, as ifogd publishes it: number; of each axis angle increment (rad), denoised rate (rad/s);
of IFOG_NOSE_IMU increments of angle and of velocity (m/s).

  subscribe.py CHANNEL COUNT [GROUP:PORT]       IFOG_NOSE 100 239.255.76.67:7667

Ends after COUNT messages. The types are those of the package ifogd-dev. Debian has no Python binding of LCM; receiving is a few
lines, as LCM's multicast is: every datagram begins with LC02, a number, and the channel's name ended by a zero byte. (A message
of over 64 kB would come in parts, with LC03; ifogd sends none.) With a binding:
  lcm.LCM().subscribe("IFOG_NOSE", lambda channel, data: print(ifog.rate_t.decode(data).denoised))
"""
import socket
import struct
import sys

import ifog

WHOLE = b"LC02"


def receive(group, port):
    """(channel, message) for each datagram of LCM that arrives."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2**21)
    listener.bind((group, port))
    listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("=4sI", socket.inet_aton(group), socket.INADDR_ANY))
    while True:
        datagram = listener.recv(65536)
        name_end = datagram.find(b"\0", 8)
        if datagram[:4] == WHOLE and name_end > 0:
            yield datagram[8:name_end].decode(), datagram[name_end + 1:]


def line(data):
    """A message in words. Each type has a hash, which its message begins with: decode() refuses another's."""
    try:
        message = ifog.rate_t.decode(data)
        axes = zip(message.delta_theta, message.denoised)
    except ValueError:
        try:
            message = ifog.imu_t.decode(data)
        except ValueError:
            sys.exit("subscribe.py: neither a rate_t nor an imu_t comes on this channel, or one of another version of ifogd")
        axes = zip(message.delta_theta, message.delta_v)
    return f"{message.seq}{''.join(f' {one:.9g} {other:.9g}' for one, other in axes)} {'gap' if message.flags & ifog.rate_t.FLAG_GAP else '-'}"


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: subscribe.py CHANNEL COUNT [GROUP:PORT]")
    wanted, left = sys.argv[1], int(sys.argv[2])
    group, port = (sys.argv[3] if len(sys.argv) > 3 else "239.255.76.67:7667").split(":")
    for channel, data in receive(group, int(port)):
        if channel != wanted:
            continue
        print(line(data), flush=True)
        left -= 1
        if left <= 0:
            return


if __name__ == "__main__":
    main()
