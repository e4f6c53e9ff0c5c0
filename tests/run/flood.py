#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drives everything that a performance can drive, in single datagrams, a tenth of them broken: each number swings up and down, or jumps at random.

    PYTHONPATH=assets/live tests/run/flood.py PORT SECONDS PER_SECOND swings|jumps

It prints how many datagrams were sent, how many of them were broken, and how many addresses there are.
"""
import math
import random
import sys
import time

from osc import Sender, message

if len(sys.argv) != 5 or sys.argv[4] not in ("swings", "jumps"):
    sys.exit(__doc__)
sender, seconds, rate = Sender(int(sys.argv[1])), float(sys.argv[2]), float(sys.argv[3])
random.seed(1)

sender.send("/imomushi/list")
names = []
while answer := sender.receive(30.0):  # a busy machine takes its time
    if answer[0] == "/imomushi/names":
        break
    names.append(answer[1])
if not names:
    sys.exit("Nobody answers: begin with \"imomushi live PROJECT\".")
phase = {name: random.uniform(0.0, math.tau) for name, _ in names}


def whole():
    name, count = random.choice(names)
    if sys.argv[4] == "jumps":
        return message(name, *(random.uniform(-1.5, 1.5) for _ in range(count)))
    return message(name, *(1.5 * math.sin(2.0 * now + 7.0 * axis + phase[name]) for axis in range(count)))


def broken():
    data = whole()
    kind = random.randrange(4)
    if kind == 0:
        return data[: random.randrange(1, len(data) - 3) | 1]  # an odd number of bytes
    if kind == 1:
        return random.randbytes(random.randrange(1, 200))
    if kind == 2:
        return data.replace(b",", b"?", 1)
    return b"#bundle\0" + random.randbytes(8) + b"\x7f\xff\xff\xff" + data


start = time.monotonic()
sent = wrong = 0
while (now := time.monotonic() - start) < seconds:
    while sent < now * rate:
        bad = random.random() < 0.1
        sender.send_bytes(broken() if bad else whole())
        sent += 1
        wrong += bad
    time.sleep(0.002)
print(sent, wrong, len(names))
