# SPDX-License-Identifier: Apache-2.0
"""A separate network namespace, in which LCM may send and nothing leaves this computer; with its own mounts if requested."""
import os
import socket
import struct
import subprocess
import sys

INSIDE = "IFOG_PRIVATE_NETWORK"
GROUP, PORT = "239.255.76.67", 7667  # of LCM


def enter(mounts=False):
    """Restarts this process in such a namespace and returns there. Its children stay there."""
    if os.environ.get(INSIDE) == "1":
        subprocess.run("ip link set lo up multicast on && ip route replace 224.0.0.0/4 dev lo", shell=True, check=True)
        return
    flags = ("-n" if os.geteuid() == 0 else "-rn") + ("m" if mounts else "")
    os.environ[INSIDE] = "1"
    os.execvp("unshare", ["unshare", flags, sys.executable, *sys.argv])


def group_socket():
    """Receives the packets of everybody on LCM's group, and sends to it."""
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    out.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    out.bind((GROUP, PORT))
    out.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("4sl", socket.inet_aton(GROUP), socket.INADDR_ANY))
    return out
