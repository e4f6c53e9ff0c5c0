# SPDX-License-Identifier: GPL-3.0-or-later
"""The studio as a screen reader has it (AT-SPI), and a pointer and keys of an X server of its own."""

import json
import os
import shutil
import struct
import subprocess
import sys
import time

LEFT_OUT = 77
WAIT = 40.0  # s: for what must happen

try:
    import gi

    gi.require_version("Atspi", "2.0")
    from gi.repository import Atspi, GLib
except (ImportError, ValueError):
    print("python3-gi and gir1.2-atspi-2.0 are not installed (packaging/install.sh test)")
    sys.exit(LEFT_OUT)
for needed in ("Xvfb", "xdotool"):
    if not shutil.which(needed):
        print(needed + " is not installed (packaging/install.sh test)")
        sys.exit(LEFT_OUT)

Role = Atspi.Role


def said(text):
    print("%6.1f s  %s" % (time.monotonic() - begun, text), flush=True)


begun = time.monotonic()


def until(what, condition):
    """What `condition` answers, once that is something."""
    end = time.monotonic() + WAIT
    while True:
        try:
            answer = condition()
        except GLib.Error:  # it went meanwhile
            answer = None
        if answer:
            return answer
        if time.monotonic() > end:
            raise SystemExit("In vain: " + what)
        time.sleep(0.03)


BUTTONS = {Role.PUSH_BUTTON}
FIELDS = {Role.TEXT, Role.ENTRY, Role.SPIN_BUTTON}
# What nothing is looked for in.
FLAT = {Role.MENU_BAR, Role.TOOL_BAR, Role.STATUS_BAR, Role.PAGE_TAB_LIST, Role.LIST, Role.TREE, Role.TREE_TABLE, Role.TABLE, Role.TEXT, Role.SPIN_BUTTON, Role.LABEL, Role.PUSH_BUTTON, Role.CHECK_BOX, Role.COMBO_BOX}


def name_of(widget):
    """Qt gives a combo box what it shows for a name; what it is called says the label that it belongs to."""
    if widget.get_role() == Role.COMBO_BOX:
        for relation in widget.get_relation_set():
            if relation.get_relation_type() == Atspi.RelationType.LABELLED_BY:
                return relation.get_target(0).get_name()
    return widget.get_name()


def shown(widget):
    return widget.get_state_set().contains(Atspi.StateType.SHOWING)


def gone(widget):
    try:
        return not shown(widget)
    except GLib.Error:
        return True


class Studio:
    def __init__(self, program, folder, display, settings=""):
        home = os.path.join(folder, "home")
        os.makedirs(os.path.join(home, "Imomushi"), exist_ok=True)
        with open(os.path.join(home, "Imomushi", "Imomushi.conf"), "w") as file:
            file.write(settings)
        self.environment = dict(os.environ, DISPLAY=display, HOME=home, XDG_CONFIG_HOME=home, XDG_DATA_HOME=home, XDG_CACHE_HOME=home, LC_ALL="C.UTF-8", QT_QPA_PLATFORM="xcb",
                                QT_LINUX_ACCESSIBILITY_ALWAYS_ON="1", LIBGL_ALWAYS_SOFTWARE="1", LP_NUM_THREADS="0")
        self.process = subprocess.Popen([program], env=self.environment, cwd=folder)
        self.app = until("the studio on the accessibility bus", self.found)
        until("its window", lambda: self.windows())

    def found(self):
        if self.process.poll() is not None:
            raise SystemExit("The studio ended by itself.")
        desktop = Atspi.get_desktop(0)
        for i in range(desktop.get_child_count()):
            app = desktop.get_child_at_index(i)
            if app and app.get_process_id() == self.process.pid:
                return app
        return None

    # ---- what a screen reader sees ----

    def windows(self):
        return [w for w in (self.app.get_child_at_index(i) for i in range(self.app.get_child_count())) if w and shown(w)]

    def look(self, roles, name):
        """In the window that is in front: the nearest thing that is shown and has one of these roles and this name; none: None."""
        todo = self.windows()[-1:]
        while todo:
            at = todo.pop(0)
            for i in range(at.get_child_count()):
                child = at.get_child_at_index(i)
                if not child or not shown(child):
                    continue
                role = child.get_role()
                if role in roles and name_of(child) == name:
                    return child
                if role not in FLAT:
                    todo.append(child)
        return None

    def find(self, roles, name):
        return until("“%s”" % name, lambda: self.look(roles, name))

    # ---- keys ----

    def xdotool(self, *arguments):
        return subprocess.run(("xdotool",) + arguments, env=self.environment, capture_output=True, text=True).stdout

    def focus_window(self):
        """There is no window manager: the topmost window of the studio gets the keys."""
        shown = self.xdotool("search", "--onlyvisible", "--pid", str(self.process.pid)).split()
        if shown:
            self.xdotool("windowfocus", "--sync", shown[-1])

    def keys(self, *names):
        self.xdotool("key", *names)

    def type(self, text):
        self.xdotool("type", "--delay", "2", "--", text)

    # ---- what an artist does ----

    def command(self, name):
        """By the search of commands and parts: F3, words, Enter."""
        self.focus_window()
        self.keys("F3")
        line = self.find(FIELDS, "Search")
        self.type(name)
        rows = self.find((Role.LIST,), "Found")
        until("“%s” as the first that is found" % name, lambda: rows.get_child_count() > 0 and rows.get_child_at_index(0).get_name() == name)
        self.keys("Return")
        until("the search closed", lambda: gone(line))
        said("command: " + name)

    def focus(self, widget, label):
        focused = lambda: widget.get_state_set().contains(Atspi.StateType.FOCUSED)
        if not focused():
            widget.grab_focus()
        # Qt's combo boxes take the focus by Tab alone.
        for _ in range(100):
            end = time.monotonic() + 0.1
            while time.monotonic() < end:
                if focused():
                    return
                time.sleep(0.01)
            self.keys("Tab")
        raise SystemExit("Tab does not reach “%s”" % label)

    def set(self, label, text):
        """A field by its name: the focus goes there, words replace what it says."""
        self.fill(label, self.find(FIELDS, label), text)

    def fill(self, label, field, text):
        self.focus(field, label)
        self.keys("ctrl+a")
        self.type(text)
        self.keys("Tab")
        said("%s: %s" % (label, text))

    def choose(self, label, choice, behind=None):
        """`behind`: a field that follows it."""
        box = self.find((Role.COMBO_BOX,), label)
        if behind:
            self.focus(self.find(FIELDS, behind), behind)
            self.keys("shift+Tab")
        self.focus(box, label)
        self.keys("alt+Down")
        rows = until("the list of “%s”" % label, lambda: next((c for c in (box.get_child_at_index(i) for i in range(box.get_child_count())) if c.get_role() == Role.LIST and shown(c)), None))
        names = [rows.get_child_at_index(i).get_name() for i in range(rows.get_child_count())]
        if choice not in names:
            raise SystemExit("“%s” has no “%s”: %s" % (label, choice, names))
        self.keys("Home", *["Down"] * names.index(choice), "Return")
        until("“%s” in “%s”" % (choice, label), lambda: box.get_name() == choice)
        said("%s: %s" % (label, choice))

    def press(self, name):
        def pressed():  # once it can be
            button = self.look(BUTTONS, name)
            return button and button.get_state_set().contains(Atspi.StateType.SENSITIVE) and button.do_action(0)

        until("the button “%s”" % name, pressed)
        said("button: " + name)

    def dialog(self, title):
        until("the dialog “%s”" % title, lambda: any(w.get_name() == title for w in self.windows()))
        time.sleep(0.05)
        self.focus_window()

    def stands(self, text):
        """In the status bar."""
        def find():
            window = self.windows()[0]
            bars = [b for b in (window.get_child_at_index(i) for i in range(window.get_child_count())) if b.get_role() == Role.STATUS_BAR]
            strip = bars[0].get_child_at_index(0)
            return any(strip.get_child_at_index(i).get_name() == text for i in range(strip.get_child_count()))
        return find

    def closed(self, title):
        until("“%s” closed" % title, lambda: all(w.get_name() != title for w in self.windows()))
        self.focus_window()

    def says(self, text):
        return lambda: self.look((Role.LABEL,), text)


def headless(program, folder, *lines):
    """What the program answers to these commands without a window, a line for each."""
    with open(os.path.join(folder, "check.jsonl"), "w") as script:
        script.writelines(json.dumps(line) + "\n" for line in lines)
    done = subprocess.run([program, "run", "check.jsonl"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    return [json.loads(line) for line in done.stdout.splitlines()]


def clips_of(path):
    """Names of the animations of a GLB."""
    with open(path, "rb") as exported:
        magic, _, _, length, kind = struct.unpack("<4sIII4s", exported.read(20))
        scene = json.loads(exported.read(length))
    assert magic == b"glTF" and kind == b"JSON"
    return [a["name"] for a in scene["animations"]]


def start_screen(size):
    """An X server of its own; its process and its name."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", size + "x24", "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as told:
        number = told.readline().strip()
    return server, ":" + number


def in_studio(program, folder, session, check, size="800x600", settings="", display=""):
    """session(studio, folder) in a studio on a screen of `size`, or on a display that is there, then check(program, folder). `settings`: of the studio, as its file has them."""
    screen = None
    if not display:
        screen, display = start_screen(size)
    try:
        os.environ["DISPLAY"] = display
        studio = Studio(program, folder, display, settings)
        try:
            session(studio, folder)
            check(program, folder)
        finally:
            studio.process.kill()
    finally:
        if screen:
            screen.terminate()
            screen.wait()
