#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the OSC address of everything that can be driven, and how many numbers each takes.

    imomushi live octopus.imomushi &
    assets/live/names.py [PORT]      9000 unless given
"""
import sys

from osc import Sender

sender = Sender(int(sys.argv[1]) if len(sys.argv) > 1 else 9000)
sender.send("/imomushi/list")
while answer := sender.receive(3.0):
    address, arguments = answer
    if address == "/imomushi/names":
        sys.exit(0)
    print(*arguments)
sys.exit("Nobody answers: begin with \"imomushi live PROJECT\".")
