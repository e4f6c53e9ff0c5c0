# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole session in the studio from outside, by keyboard and accessibility (AT-SPI) alone, as a screen reader has it: no mouse, no picture.

by_keyboard.py PROGRAM FOLDER: run under dbus-run-session. Writes into FOLDER; what it did is printed, a line for each step. The status is 77 where something that it needs is missing.
"""

import os
import sys
import time

from studio_client import BUTTONS, FIELDS, WAIT, clips_of, headless, in_studio, said, until


def session(studio, folder):
    studio.focus_window()
    studio.keys("ctrl+i")
    studio.dialog("Import meshes")
    studio.type(os.path.join(folder, "body.obj"))
    studio.keys("Return")
    studio.closed("Import meshes")
    studio.dialog("Import body.obj")
    studio.press("Import")
    studio.closed("Import body.obj")

    studio.command("Soft at once")  # off: the precompute is asked for
    studio.command("Place a cut")
    studio.dialog("Place a cut")
    studio.set("Name", "waist")
    studio.set("Origin: Z", "0.1")
    studio.press("Place")
    studio.closed("Place a cut")
    studio.set("Origin at rest: Z", "0.25")  # of the cut, which is selected now

    for body, face, z, outward in (("body", "tail", "-2", "-1"), ("body 2", "tip", "2", "1")):
        studio.command("Place a joint face")
        studio.dialog("Place a joint face")
        studio.set("Name", face)
        studio.choose("Element", body)
        studio.set("Origin: Z", z)
        for axis, number in (("X", "0"), ("Y", "0"), ("Z", outward)):  # what is proposed is across the longest side
            studio.set("Normal: " + axis, number)
        studio.press("Place")
        studio.closed("Place a joint face")
    studio.set("Name", "nose")

    for bone, start, end in (("rear", "body/tail", "body/waist"), ("front", "rear/end", "body 2/nose")):
        studio.command("Place a bone")
        studio.dialog("Place a bone")
        studio.set("Name", bone)
        studio.choose("Start", start)
        studio.choose("End", end)
        studio.press("Place")
        studio.closed("Place a bone")
    studio.set("End at rest: Z", "1.5")
    until("the bone is shorter", studio.says("Length: 1.25 m"))
    studio.choose("End", "body 2/nose", behind="End at rest: X")
    studio.set("Longest", "180")

    studio.command("body")
    studio.set("Stiffness", "1.5")

    studio.command("Precompute")
    until("everything is precomputed", studio.stands("State of the precompute: Soft"))

    studio.command("front/end")
    studio.set("Target: Y", "0.6")
    record, target = studio.find(BUTTONS, "Record"), studio.find(FIELDS, "Target: Y")
    record.do_action(0)
    time.sleep(1.0)
    said("recording")
    studio.fill("Target: Y", target, "-0.6")
    time.sleep(1.5)  # on a busy machine a step takes a while
    record.do_action(0)
    said("recorded")

    studio.command("Export")
    studio.dialog("Export")
    studio.set("File", os.path.join(folder, "out.glb"))
    studio.press("Export")
    until("the file was written", lambda: os.path.exists(os.path.join(folder, "out.glb")))
    studio.press("Close")
    studio.closed("Export")

    studio.keys("ctrl+s")
    studio.dialog("Save the project as")
    studio.type(os.path.join(folder, "out.imomushi"))
    studio.keys("Return")
    studio.closed("Save the project as")
    until("the project was saved", lambda: studio.windows()[0].get_name().startswith("out "))
    studio.focus_window()
    studio.keys("ctrl+q")
    status = studio.process.wait(WAIT)
    said("the studio ended: %d" % status)
    assert status == 0


def check(program, folder):
    """What was written, opened without a window."""
    def at(time):
        return headless(program, folder, {"do": "open", "path": "out.imomushi"}, {"do": "play", "take": "Take 1", "time": time}, {"do": "measure", "what": "position", "endpoint": "front/end"})

    answers = at(0.0)
    end = at(answers[1]["seconds"])
    there = answers[0]
    elements = {e["name"]: e for e in there["elements"]}
    assert sorted(elements["body"]["faces"]) == ["tail", "waist"] and sorted(elements["body 2"]["faces"]) == ["nose", "waist"], elements
    assert all(e["state"] == "fresh" for e in elements.values()), elements
    cut = there["characters"][0]["cuts"][0]
    assert cut["name"] == "waist" and abs(cut["origin"][2] - 0.25) < 1e-9, cut
    bones = {b["name"]: (b["start"], b["end"]) for b in there["bones"]}
    assert bones == {"rear": ("body/tail", "body/waist"), "front": ("rear/end", "body 2/nose")}, bones
    assert there["takes"] == ["Take 1"], there["takes"]
    first, later = (a[2]["value"][1] for a in (answers, end))
    assert abs(first - 0.6) < 0.05 and abs(later + 0.6) < 0.05, (first, later)
    assert clips_of(os.path.join(folder, "out.glb")) == ["Take 1"]
    said("project, take and exported file hold what was done")


if __name__ == "__main__":
    in_studio(*sys.argv[1:], session, check)
