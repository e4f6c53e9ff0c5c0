# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole session in the studio from outside, by the pointer of the X server: only names and paths are typed. Where things are says accessibility (AT-SPI), and what is under the pointer, too.

by_mouse.py PROGRAM FOLDER [LANGUAGE THEME SCALE [PICTURES [DISPLAY]]]: run under dbus-run-session. On a screen of its own of 1280 x 720, or on a display whose first monitor is so large and which may have others.
Pictures go to PICTURES, where ImageMagick is there.
"""

import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree

from studio_client import BUTTONS, FIELDS, FLAT, Atspi, Role, WAIT, clips_of, headless, in_studio, name_of, said, shown, until

WIDTH, HEIGHT = 1280, 720
TURN = 1.5  # s: the view has turned, also where the processor draws it beside other work


class Mouse:
    """The studio, and a hand on its mouse. Names are English; what is looked for is what they are in the language of the session."""

    def __init__(self, studio, words, pictures, scale):
        self.studio, self.words, self.pictures, self.scale = studio, words, pictures, scale
        self.kept = 0
        self.at = None

    def tr(self, source):
        return self.words.get(source, source).replace("&", "")

    # ---- the pointer ----

    def to(self, x, y):
        if self.at == (round(x), round(y)):
            return  # xdotool would wait for a motion that never comes
        self.at = (round(x), round(y))
        self.studio.xdotool("mousemove", "--sync", *map(str, self.at))

    def click(self, x, y, times=1):
        self.to(x, y)
        self.studio.xdotool("click", "--repeat", str(times), "--delay", "60", "1")

    def drag(self, start, by, hold=0.0):
        """In steps, as a hand does. `hold`: seconds that the button stays down at the end."""
        self.to(*start)
        time.sleep(0.1)
        self.studio.xdotool("mousedown", "1")
        for i in range(1, 13):
            self.to(start[0] + by[0] * i / 12, start[1] + by[1] * i / 12)
            time.sleep(0.03)
        time.sleep(hold)
        self.studio.xdotool("mouseup", "1")

    def middle(self, widget):
        at = widget.get_extents(Atspi.CoordType.SCREEN)
        if at.width <= 0 or at.x < 0 or at.y < 0 or at.x + at.width > WIDTH or at.y + at.height > HEIGHT:
            raise SystemExit("“%s” is not on the first monitor: %d, %d, %d x %d" % (name_of(widget), at.x, at.y, at.width, at.height))
        return at.x + at.width / 2, at.y + at.height / 2

    def on(self, widget, times=1):
        self.click(*self.middle(widget), times)

    # ---- what an artist does ----

    def keep(self, name):
        if self.pictures:
            self.kept += 1
            time.sleep(0.4)
            subprocess.run(["import", "-window", "root", os.path.join(self.pictures, "%02d-%s.png" % (self.kept, name))], env=self.studio.environment)

    def menu(self, *path):
        """A way through the menus."""
        bar = until("the menus", lambda: next((c for c in children(self.studio.windows()[0]) if c.get_role() == Role.MENU_BAR), None))
        at = bar
        for source in path:
            name = self.tr(source)
            at = until("“%s” in the menus" % name, lambda: entry(at, name))
            if not ready(at):
                raise SystemExit("“%s” cannot be chosen now" % name)
            self.on(at)
        said("menu: " + " > ".join(path))

    def press(self, source):
        name = self.tr(source)
        button = until("the button “%s”" % name, lambda: ready(self.studio.look(BUTTONS | {Role.CHECK_BOX}, name)))
        self.on(button)
        said("button: " + source)

    def clear(self):
        """Closes what is said over the view, where something is."""
        view = self.view().get_extents(Atspi.CoordType.SCREEN)
        todo = [self.studio.windows()[0]]
        while todo:
            for child in children(todo.pop()):
                if not shown(child):
                    continue
                at = child.get_extents(Atspi.CoordType.SCREEN)
                if child.get_role() in BUTTONS and child.get_name() == self.tr("Close") and view.x <= at.x < view.x + view.width and view.y <= at.y < view.y + view.height:
                    self.on(child)
                    time.sleep(0.3)
                elif child.get_role() not in FLAT:
                    todo.append(child)

    def tool(self, source):
        """In the bar of tools."""
        name = re.sub(r"\(&.\)|&", "", self.words.get(source, source))  # a tool has no mnemonic
        window = self.studio.windows()[0]
        def find():
            for bar in (c for c in children(window) if c.get_role() == Role.TOOL_BAR and shown(c)):
                for button in children(bar):
                    if shown(button) and button.get_name() == name:
                        return button
        self.on(until("the tool “%s”" % name, find))
        said("tool: " + source)

    def field(self, source, text):
        """A field by its name: a click, and words replace what it says."""
        box = self.studio.find(FIELDS, self.tr(source))
        panel = self.studio.windows()[-1].get_extents(Atspi.CoordType.SCREEN)
        for _ in range(40):  # by the wheel, until it is in sight
            box = self.studio.find(FIELDS, self.tr(source))
            at = box.get_extents(Atspi.CoordType.SCREEN)
            if at.y + at.height < panel.y + panel.height - 50:
                break
            self.to(at.x - 20, panel.y + panel.height - 120)
            self.studio.xdotool("click", "5")
            time.sleep(0.1)
        self.on(box)
        self.studio.keys("ctrl+a")
        self.studio.type(text)
        self.studio.keys("Tab")

    def dialog(self, source, name=""):
        self.studio.dialog(self.tr(source).replace("%1", name))

    def hint(self, source):
        """Waits until the status bar says this first."""
        wanted = self.tr(source)
        def says():
            bar = next(b for b in children(self.studio.windows()[0]) if b.get_role() == Role.STATUS_BAR)
            return any(label.get_name().startswith(wanted) for strip in children(bar) for label in children(strip))
        until("“%s” in the status bar" % wanted, says)

    def name(self, was, name):
        """What is selected gets a name, in its properties."""
        until("“%s” in the properties" % was, lambda: self.studio.look(FIELDS, self.tr("Name")).get_text(0, -1) == was)
        said("selected: " + was)
        self.field("Name", name)
        said("renamed: " + name)
        time.sleep(0.2)

    def until_settled(self):
        until("nothing is worked on", lambda: len(self.studio.windows()) == 1)
        time.sleep(TURN)

    # ---- the view ----

    def view(self):
        def find():
            todo = [self.studio.windows()[0]]
            while todo:
                at = todo.pop(0)
                for child in children(at):
                    if child.get_name() == self.tr("View of the character"):
                        return child
                    if shown(child) and child.get_role() not in FLAT:
                        todo.append(child)
        if not hasattr(self, "view_"):
            self.view_ = until("the view", find)
        return self.view_

    def under(self):
        """What the view says is under the pointer."""
        words = self.view().get_description()
        pattern = re.escape(self.tr("Selected: %1. Under the pointer: %2")).replace("%1", "(.*)").replace("%2", "(.*)")
        found = re.fullmatch(pattern, words)
        return found.group(2) if found else words

    def seek(self, source, name, along):
        """Moves the pointer along places until the view says that this is under it, and on to the middle of where it says so. Answers that place. `name`: a regular expression."""
        wanted = re.compile(re.escape(self.tr(source)).replace("%1", name))
        places, first = list(along), None
        for patience in (0.05, 0.3):  # s; a busy machine says it late
            for place in places:
                self.to(*place)
                time.sleep(patience)
                if wanted.fullmatch(self.under()):
                    first = first or place
                    last = place
                elif first:
                    break
            if first:
                break
        if not first:
            raise SystemExit("The view never says “%s”; at last “%s”" % (wanted.pattern, self.view().get_description()))
        at = ((first[0] + last[0]) / 2, (first[1] + last[1]) / 2)
        self.to(*at)
        time.sleep(0.05)
        return at

    def ball(self, right, up):
        """Ends of axes on the ball in the corner of the view."""
        at = self.view().get_extents(Atspi.CoordType.SCREEN)
        return at.x + at.width - (56 - 34 * right) * self.scale, at.y + (56 - 34 * up) * self.scale

    def across(self, y=0.5, step=5):
        """Places on a line through the view, from left to right."""
        at = self.view().get_extents(Atspi.CoordType.SCREEN)
        return [(x, at.y + at.height * y) for x in range(at.x + 20, at.x + at.width - 20, step)]


def children(widget):
    return [c for c in (widget.get_child_at_index(i) for i in range(widget.get_child_count())) if c]


def entry(menu, name):
    """Of a menu that is open, or the bar of menus."""
    todo = children(menu)
    while todo:
        at = todo.pop(0)
        if at.get_name() == name and shown(at) and at.get_extents(Atspi.CoordType.SCREEN).width > 0:
            return at
        if at.get_role() in (Role.MENU, Role.POPUP_MENU) and at.get_name() != name and menu.get_role() != Role.MENU_BAR:
            todo += children(at)
    return None


def ready(button):
    return button if button and button.get_state_set().contains(Atspi.StateType.SENSITIVE) else None


def session(mouse, folder):
    studio = mouse.studio
    studio.focus_window()
    mouse.keep("start")
    mouse.menu("&File", "&Import mesh…")
    mouse.dialog("Import meshes")
    studio.type(os.path.join(folder, "body.obj"))
    studio.keys("Return")
    mouse.dialog("Import %1", "body.obj")
    mouse.on(until("the kinds of an import", lambda: studio.look({Role.RADIO_BUTTON, Role.PUSH_BUTTON, Role.CHECK_BOX}, mouse.tr("Whole character"))))
    mouse.press("Make it soft: cuts and bones as its shape suggests")  # off: all is placed by hand
    mouse.keep("import")
    mouse.press("Import")
    until("the import closed", lambda: len(studio.windows()) == 1)
    studio.focus_window()

    mouse.menu("&Character", "Soft at &once")  # off: the precompute is asked for
    mouse.menu("&View", "Right")
    mouse.menu("&View", "Frame &all")
    time.sleep(1.0)
    mouse.keep("imported")

    # A cut across the middle, which is dragged aside afterwards.
    mouse.clear()
    x, y = mouse.middle(mouse.view())
    mouse.tool("Joint &face")
    mouse.to(x + 20, y)
    mouse.hint("Click: cut across · Shift+click: plane · ↑: a patch of the surface instead")
    said("a cut is offered")
    mouse.click(x + 20, y)
    mouse.name("cut 1", "waist")
    mouse.keep("cut")
    mouse.clear()
    mouse.tool("&Select")
    mouse.drag(mouse.seek("cut “%1”", "waist", mouse.across()), (60, 0))
    mouse.until_settled()

    # Joint faces on both ends, seen from there; the second way there is the ball of axes.
    mouse.menu("&View", "Front")
    time.sleep(TURN)
    corner = mouse.view().get_extents(Atspi.CoordType.SCREEN)
    mouse.click(corner.x + 30, corner.y + 30)  # nothing is selected: the plane of the cut is out of the way
    mouse.tool("Joint &face")
    mouse.clear()
    mouse.click(*mouse.middle(mouse.view()))
    mouse.name("face 1", "nose")
    mouse.menu("&View", "Right")
    time.sleep(TURN)
    mouse.click(*mouse.ball(1, 0))
    time.sleep(TURN)
    mouse.clear()
    mouse.keep("behind")
    mouse.click(*mouse.middle(mouse.view()))
    mouse.name("face 1", "tail")

    # Bones from the tail over the cut to the nose, and the longest that one becomes.
    mouse.menu("&View", "Right")
    mouse.menu("&View", "Frame &all")
    time.sleep(TURN)
    mouse.to(*mouse.middle(mouse.view()))
    studio.xdotool("click", "--repeat", "3", "--delay", "60", "5")  # smaller, so that nothing lies under the ball of axes
    time.sleep(0.4)
    mouse.tool("&Bone")
    mouse.clear()
    nose = mouse.seek("joint face “%1”", ".*/nose", mouse.across())
    waist = mouse.seek("joint face “%1”", ".*/cut 1", mouse.across())
    tail = mouse.seek("joint face “%1”", ".*/tail", mouse.across())
    for at in (tail, waist, nose):
        mouse.click(*at)
        time.sleep(0.3)
    studio.keys("Escape")
    mouse.keep("bones")
    mouse.field("Longest", "180")

    mouse.tool("&Precompute")
    until("everything is precomputed", studio.stands(mouse.tr("State of the precompute: %1").replace("%1", mouse.tr("Soft"))))

    # The end is dragged while it is recorded, and again on the stage.
    mouse.tool("&Drag")
    mouse.clear()
    end = mouse.seek("end of a bone “%1”", ".*/end", mouse.across())
    mouse.press("Record")
    mouse.drag(end, (-20, -90), hold=0.6)
    mouse.keep("dragged")
    mouse.press("Stop recording")
    mouse.menu("&View", "Stage: the character alo&ne")
    time.sleep(1.5)
    mouse.keep("stage")
    end = mouse.seek("end of a bone “%1”", ".*/end", ((x, y) for y in range(60, HEIGHT - 60, 12) for x in range(40, WIDTH - 40, 12)))
    mouse.drag(end, (0, 200), hold=0.3)
    mouse.keep("stage-dragged")
    studio.keys("Escape")
    time.sleep(1.0)

    mouse.menu("&File", "&Export…")
    mouse.dialog("Export")
    mouse.keep("export")
    mouse.field("File", os.path.join(folder, "out.glb"))
    mouse.press("Export")
    until("the file was written", lambda: os.path.exists(os.path.join(folder, "out.glb")))
    mouse.press("Close")
    until("the export closed", lambda: len(studio.windows()) == 1)
    studio.focus_window()

    mouse.menu("&File", "Save &as…")
    mouse.dialog("Save the project as")
    studio.type(os.path.join(folder, "out.imomushi"))
    studio.keys("Return")
    until("the project was saved", lambda: studio.windows()[0].get_name().startswith("out "))
    studio.focus_window()
    mouse.keep("end")
    mouse.menu("&File", "&Quit")
    status = studio.process.wait(WAIT)
    said("the studio ended: %d" % status)
    assert status == 0


def check(program, folder):
    """What was written, opened without a window."""
    there = headless(program, folder, {"do": "open", "path": "out.imomushi"})[0]
    elements = {e["name"]: e for e in there["elements"]}
    assert sorted(sorted(e["faces"]) for e in elements.values()) == [["cut 1", "nose"], ["cut 1", "tail"]], elements
    assert all(e["state"] == "fresh" for e in elements.values()), elements
    cut = there["characters"][0]["cuts"][0]
    assert cut["name"] == "waist" and abs(cut["origin"][2]) > 0.1, cut
    assert len(there["bones"]) == 2 and len(there["takes"]) == 1, there
    assert clips_of(os.path.join(folder, "out.glb")) == there["takes"]
    said("project, take and exported file hold what was done")


def watched(mouse, folder):
    """The session; where it ends too early, a picture of what was there."""
    try:
        session(mouse, folder)
    except (SystemExit, Exception):
        mouse.keep("failed")
        raise


def main(program, folder, language="en", theme="dark", scale="1", pictures="", display=""):
    words = {}
    if language != "en":
        here = os.path.dirname(os.path.abspath(__file__))
        for message in xml.etree.ElementTree.parse(os.path.join(here, "../../assets/translations/imomushi_%s.ts" % language)).iter("message"):
            words.setdefault(message.findtext("source"), message.findtext("translation"))
    settings = "[appearance]\nlanguage=%s\ntheme=%s\nscale=%s\n" % (language, theme, scale)
    in_studio(program, folder, lambda studio, to: watched(Mouse(studio, words, pictures, float(scale)), to), check, "%dx%d" % (WIDTH, HEIGHT), settings, display)


if __name__ == "__main__":
    main(*sys.argv[1:])
