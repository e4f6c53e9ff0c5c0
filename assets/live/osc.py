# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Sound Control, as far as these senders need it: messages of numbers and texts over UDP."""
import socket
import struct


def text(value):
    data = value.encode()
    return data + b"\0" * (4 - len(data) % 4)


def message(address, *arguments):
    """Floats are "f", whole numbers "i", texts "s"."""
    tags, data = ",", b""
    for a in arguments:
        if isinstance(a, str):
            tags, data = tags + "s", data + text(a)
        elif isinstance(a, int):
            tags, data = tags + "i", data + struct.pack(">i", a)
        else:
            tags, data = tags + "f", data + struct.pack(">f", a)
    return text(address) + text(tags) + data


def bundle(*messages):
    """Messages that count at once."""
    return text("#bundle") + struct.pack(">Q", 1) + b"".join(struct.pack(">i", len(m)) + m for m in messages)


def read(packet):
    """The address and the arguments of a message."""
    def take_text(at):
        end = packet.index(b"\0", at)
        return packet[at:end].decode(), end + 4 - (end - at) % 4

    address, at = take_text(0)
    tags, at = take_text(at)
    arguments = []
    for tag in tags[1:]:
        if tag == "s":
            value, at = take_text(at)
        else:
            value, at = struct.unpack_from(">i" if tag == "i" else ">f", packet, at)[0], at + 4
        arguments.append(value)
    return address, arguments


class Sender:
    def __init__(self, port, host="127.0.0.1"):
        self.to = (host, port)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, address, *arguments):
        self.socket.sendto(message(address, *arguments), self.to)

    def send_bytes(self, data):
        self.socket.sendto(data, self.to)

    def receive(self, seconds):
        """The next answer; None: none came in time."""
        self.socket.settimeout(seconds)
        try:
            return read(self.socket.recv(65536))
        except socket.timeout:
            return None
