#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A body by the VMC protocol: bones that are turned about their parents, each in a datagram of its own, 60 times a second.

    assets/live/body.py PORT SECONDS BONE X Y Z [BONE X Y Z ...]

BONE is a name of Unity's HumanBodyBones (Hips, Spine, LeftUpperArm, ...). X, Y, Z are its rotation vector in degrees, right-handed, Y up; the protocol's axes are left-handed.
A bone by "map-input": its numbers 7, 8 and 9 of the channel "bone/BONE" are that vector in radians, for "bone/NAME/turn-x", "turn-y" and "turn-z".
"""
import math
import sys
import time

from osc import Sender


def quaternion(x, y, z):
    """x y z w of the rotation by as many degrees as (x, y, z) is long, in the protocol's axes: x is mirrored."""
    angle = math.sqrt(x * x + y * y + z * z)
    part = math.sin(math.radians(angle) / 2) / angle if angle else 0.0
    return x * part, -y * part, -z * part, math.cos(math.radians(angle) / 2)


if len(sys.argv) < 7 or (len(sys.argv) - 3) % 4:
    sys.exit(__doc__)
sender, seconds = Sender(int(sys.argv[1])), float(sys.argv[2])
bones = [(sys.argv[i], quaternion(*map(float, sys.argv[i + 1 : i + 4]))) for i in range(3, len(sys.argv), 4)]
start = time.monotonic()
while (now := time.monotonic() - start) < seconds:
    sender.send("/VMC/Ext/OK", 1)
    sender.send("/VMC/Ext/T", now)
    sender.send("/VMC/Ext/Root/Pos", "root", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    for name, turn in bones:
        sender.send("/VMC/Ext/Bone/Pos", name, 0.0, 0.0, 0.0, *turn)
    time.sleep(1 / 60)
