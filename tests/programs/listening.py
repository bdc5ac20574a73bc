# SPDX-License-Identifier: Apache-2.0
"""The network addresses where a process listens."""

import os
import socket
import struct


def sockets_of(process_id):
    """The receiving sockets of the process: (protocol, address, port)."""
    inodes = set()
    for fd in os.listdir(f"/proc/{process_id}/fd"):
        try:
            target = os.readlink(f"/proc/{process_id}/fd/{fd}")
        except FileNotFoundError:  # closed in the meantime
            continue
        if target.startswith("socket:["):
            inodes.add(target[8:-1])
    found = set()
    for protocol in ("tcp", "tcp6", "udp", "udp6"):
        with open(f"/proc/{process_id}/net/{protocol}", encoding="ascii") as table:
            for line in list(table)[1:]:
                words = line.split()
                listens = protocol.startswith("udp") or words[3] == "0A"
                if words[9] in inodes and listens:
                    address, port = words[1].split(":")
                    name = socket.inet_ntoa(struct.pack("=I", int(address, 16))) if len(address) == 8 else address
                    found.add((protocol, name, int(port, 16)))
    return found
