#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of the program: how large each is, what it includes, and whether anything runs back up.

    packaging/rooms.py          a table; exits with 1 where a room includes one that its link line does not name, the rooms form a circle, or a long file has no reason
    packaging/rooms.py --dot    the same as a picture for Graphviz
"""
import re
import sys
from pathlib import Path

# Files of over 500 lines, and why they are one.
LONG = {
    "core/document/character_cuts.cpp": "one algorithm: all cuts of a character, and what its faces and joints become",
    "core/export/gltf_writer.cpp": "one format: what the parts of a glTF file name in each other",
    "core/io/reader_gltf.cpp": "one format",
    "core/proposal/shape_proposal.cpp": "one algorithm: limbs, cuts and bones from a shape",
    "core/session/session.cpp": "the one door, and what follows from each way through it",
    "ui/dialogs/import_dialog.cpp": "one dialog",
    "ui/picking/picking.cpp": "all that is found under the pointer, nearest first, by the same rules",
    "ui/tools/face_tool.cpp": "one tool",
    "ui/tools/proposal_tool.cpp": "one tool",
    "ui/window/file_flow.cpp": "one flow: asking, reading and writing files share what is prepared beside the window",
    "ui/window/main_window.cpp": "who hears whom in the window",
}

root = Path(__file__).resolve().parent.parent
room_at, links = {}, {}  # folder -> room; room -> rooms that its link line names
for name in ("core/CMakeLists.txt", "ui/CMakeLists.txt", "ui/studio.cmake", "app/CMakeLists.txt"):
    text = re.sub(r"#.*", "", (root / name).read_text())
    for room, folder, rest in re.findall(r"imomushi_library\(imomushi_(\w+) (\S+)([^)]*)\)", text):
        room_at[folder] = room
        links[room] = set(re.findall(r"\bimomushi_(\w+)", rest)) - {"eigen"}
    for room, rest in re.findall(r"target_link_libraries\(imomushi_(\w+)([^)]*)\)", text):
        links.setdefault(room, set()).update(set(re.findall(r"\bimomushi_(\w+)", rest)) - {"eigen"})


def reach(room, seen=()):
    """All rooms that a room may include. A circle ends the program."""
    if room in seen:
        sys.exit("Circle: " + " -> ".join([*seen[seen.index(room):], room]))
    return set().union(*({below} | reach(below, (*seen, room)) for below in links.get(room, ())))


files = sorted(str(f.relative_to(root)) for top in ("core", "ui", "app") for f in (root / top).rglob("*") if f.suffix in (".h", ".cpp"))
lines, edges, long, wrong = {}, {}, [], []
for file in files:
    room = room_at.get(str(Path(file).parent))
    if not room:
        continue
    text = (root / file).read_text()
    count = text.count("\n")
    lines[room] = lines.get(room, 0) + count
    if count > 500:
        long.append(f"{file} {count}: {LONG.get(file, '?')}")
        if file not in LONG:
            wrong.append(f"{file} has {count} lines: divide it, or say in packaging/rooms.py why it is one")
    for included in re.findall(r'#include "((?:core|ui|app)/[^"]*)/[^/"]*"', text):
        other = room_at.get(included)
        if other and other != room:
            edges.setdefault(room, {}).setdefault(other, []).append(file)
for room, others in edges.items():
    may = reach(room)
    wrong += [f"{file} includes {other}, which the link line of {room} does not name" for other, names in others.items() if other not in may for file in names]

if "--dot" in sys.argv:
    print("digraph rooms { rankdir=BT; node [shape=box fontname=sans];")
    for room in lines:
        print(f'  {room} [label="{room}\\n{lines[room]} lines"];')
        below = links.get(room, set()) & set(lines)
        for other in sorted(below - set().union(*(reach(b) for b in below))):
            print(f"  {room} -> {other};")
    print("}")
else:
    for room in sorted(lines, key=lambda r: (len(reach(r)), r)):
        print(f"{room:18}{lines[room]:7} lines, includes {', '.join(sorted(edges.get(room, {})))}")
    print(f"{sum(lines.values())} lines. Over 500:")
    print("\n".join(f"  {line}" for line in long))
print("\n".join(wrong), end="\n" if wrong else "", file=sys.stderr)
sys.exit(bool(wrong))
