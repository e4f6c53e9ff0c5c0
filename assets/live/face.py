#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A face by the VMC protocol, as face trackers send it: some blend values that count together, each in a datagram of its own.

    assets/live/face.py [PORT [SECONDS]]      39539 and 10 unless given
"""
import math
import sys
import time

from osc import Sender

sender = Sender(int(sys.argv[1]) if len(sys.argv) > 1 else 39539)
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
start = time.monotonic()
while (now := time.monotonic() - start) < seconds:
    sender.send("/VMC/Ext/OK", 1)
    sender.send("/VMC/Ext/T", now)
    for i, name in enumerate(("Joy", "Angry", "A", "Blink_L", "Blink_R")):
        sender.send("/VMC/Ext/Blend/Val", name, 0.5 - 0.5 * math.cos(math.tau * now * (i + 1) / 4))
    sender.send("/VMC/Ext/Blend/Apply")
    time.sleep(1 / 60)
