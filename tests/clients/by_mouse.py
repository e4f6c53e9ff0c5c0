# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole session in the studio from outside, by the pointer of the X server: only names and paths are typed. Where things are says accessibility (AT-SPI), and what is under the pointer, too.

by_mouse.py PROGRAM FOLDER [LANGUAGE THEME SCALE [PICTURES]]: run under dbus-run-session, on a screen of two monitors of 1280 x 720. Pictures go to PICTURES, where ImageMagick is there.
"""

import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree

from studio_client import BUTTONS, FIELDS, FLAT, Atspi, Role, Studio, WAIT, clips_of, gone, headless, in_studio, name_of, said, shown, until

WIDTH, HEIGHT = 1280, 720


class Mouse:
    """The studio, and a hand on its mouse. Names are English; what is looked for is what they are in the language of the session."""

    def __init__(self, studio, words, pictures):
        self.studio, self.words, self.pictures = studio, words, pictures
        self.kept = 0

    def tr(self, source):
        return self.words.get(source, source).replace("&", "")

    # ---- the pointer ----

    def to(self, x, y):
        self.studio.xdotool("mousemove", "--sync", str(round(x)), str(round(y)))

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
            if at.get_state_set().contains(Atspi.StateType.SENSITIVE) is False:
                raise SystemExit("“%s” cannot be chosen now" % name)
            self.on(at)
        said("menu: " + " > ".join(path))

    def press(self, source):
        name = self.tr(source)
        button = until("the button “%s”" % name, lambda: ready(self.studio.look(BUTTONS | {Role.CHECK_BOX}, name)))
        self.on(button)
        said("button: " + source)

    def tool(self, source):
        """In the bar of tools, by the beginning of its name, which goes on with its key."""
        name = self.tr(source)
        window = self.studio.windows()[0]
        def find():
            for bar in (c for c in children(window) if c.get_role() == Role.TOOL_BAR and shown(c)):
                for button in children(bar):
                    if shown(button) and button.get_name() == name:
                        return button
        self.on(until("the tool “%s”" % name, find))
        said("tool: " + source)

    def field(self, label, text, many=False):
        box = self.studio.find(FIELDS, label)
        self.on(box, 3 if many else 2)
        self.studio.keys("ctrl+a")
        self.studio.type(text)
        self.studio.keys("Tab")

    def dialog(self, source, *names):
        self.studio.dialog(self.tr(source) % names if "%s" in source else self.tr(source).replace("%1", *names) if names else self.tr(source))

    def hint(self, source):
        """Waits until the status bar says this first."""
        wanted = self.tr(source)
        def says():
            bar = next(b for b in children(self.studio.windows()[0]) if b.get_role() == Role.STATUS_BAR)
            return any(label.get_name().startswith(wanted) for strip in children(bar) for label in children(strip))
        until("“%s” in the status bar" % wanted, says)

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
        """Moves the pointer along places until the view says that this is under it, and on to the middle of where it says so. Answers that place."""
        wanted = self.tr(source).replace("%1", name)
        first = None
        for place in along:
            self.to(*place)
            time.sleep(0.06)
            if self.under() == wanted:
                first = first or place
                last = place
            elif first:
                break
        if not first:
            raise SystemExit("The view never says “%s”; at last “%s”" % (wanted, self.view().get_description()))
        at = ((first[0] + last[0]) / 2, (first[1] + last[1]) / 2)
        self.to(*at)
        time.sleep(0.06)
        return at

    def across(self, y=0.5, step=5):
        """Places on a line through the view, from left to right."""
        at = self.view().get_extents(Atspi.CoordType.SCREEN)
        return [(x, at.y + at.height * y) for x in range(at.x + 40, at.x + at.width - 40, step)]


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

    # A cut across the middle, which is dragged afterwards.
    x, y = mouse.middle(mouse.view())
    mouse.tool("Joint &face")
    mouse.to(x + 20, y)
    mouse.hint("Click: cut across · Shift+click: plane · ↑: a patch of the surface instead")
    mouse.keep("cut")
    mouse.click(x + 20, y)
    mouse.keep("cut-made")


def watched(mouse, folder):
    """The session; where it ends too early, a picture of what was there."""
    try:
        session(mouse, folder)
    except (SystemExit, Exception):
        mouse.keep("failed")
        raise


def main(program, folder, language="en", theme="dark", scale="1", pictures=""):
    words = {}
    if language != "en":
        here = os.path.dirname(os.path.abspath(__file__))
        for message in xml.etree.ElementTree.parse(os.path.join(here, "../../assets/translations/imomushi_%s.ts" % language)).iter("message"):
            words.setdefault(message.findtext("source"), message.findtext("translation"))
    def monitors(display):
        for name, x in (("left", 0), ("right", WIDTH)):
            subprocess.run(["xrandr", "--setmonitor", name, "%d/300x%d/170+%d+0" % (WIDTH, HEIGHT, x), "screen" if x == 0 else "none"], check=True)
    settings = "[appearance]\nlanguage=%s\ntheme=%s\nscale=%s\n" % (language, theme, scale)
    in_studio(program, folder, lambda studio, to: watched(Mouse(studio, words, pictures), to), lambda *_: None, "%dx%d" % (2 * WIDTH, HEIGHT), monitors, settings)


if __name__ == "__main__":
    main(*sys.argv[1:])
