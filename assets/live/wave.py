#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Waves numbers of OSC addresses up and down, 60 times a second.

    assets/live/wave.py PORT SECONDS ADDRESS MIDDLE SWING [MIDDLE SWING ...]

    assets/live/wave.py 9000 10 /imomushi/handle/tip/position 0 0.1 0.5 0.2 0 0
"""
import math
import sys
import time

from osc import Sender

if len(sys.argv) < 6 or len(sys.argv) % 2 == 1:
    sys.exit(__doc__)
sender, seconds, address = Sender(int(sys.argv[1])), float(sys.argv[2]), sys.argv[3]
numbers = [float(a) for a in sys.argv[4:]]
start = time.monotonic()
while (now := time.monotonic() - start) < seconds:
    sender.send(address, *(middle + swing * math.sin(math.tau * now) for middle, swing in zip(numbers[::2], numbers[1::2])))
    time.sleep(1 / 60)
