#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the bodies whose finite-element answers lie in this folder: NAME.obj (closed, outward) and NAME.faces.json.

    make_bodies.py FOLDER        (needs numpy and scipy; the same bytes every time)

Every body is a surface over (s, t), s from end to end and t once around, on a grid whose inner points are moved by some of its spacing, so
that triangles are as uneven as a modelling program leaves them; ends are planes filled by a Delaunay triangulation.
"""
import json
import sys

import numpy as np
from scipy.spatial import Delaunay

rng = np.random.default_rng(5)


class Body:
    def __init__(self):
        self.points, self.triangles, self.faces = [], [], []

    def add(self, points):
        first = len(self.points)
        self.points += [np.round(p, 9) for p in points]
        return list(range(first, len(self.points)))

    def loft(self, place, rings, around, loose_s=lambda i: True, loose_t=lambda j: True, shake=0.2, inward=False):
        """place(s, t) for s, t in 0...1; returns the first and the last ring, as indices."""
        grid = []
        for i in range(rings):
            ring = []
            for j in range(around):
                inner = 0 < i < rings - 1
                s = (i + (shake * rng.uniform(-1, 1) if inner and loose_s(i) else 0)) / (rings - 1)
                t = (j + (shake * rng.uniform(-1, 1) if inner and loose_t(j) else 0)) / around
                ring.append(place(s, t))
            grid.append(self.add(ring))
        p = self.points
        for i in range(rings - 1):
            for j in range(around):
                a, b = grid[i][j], grid[i][(j + 1) % around]
                d, c = grid[i + 1][j], grid[i + 1][(j + 1) % around]
                short = np.linalg.norm(p[a] - p[c]) * rng.uniform(0.9, 1.1) < np.linalg.norm(p[b] - p[d])
                quad = [(a, b, c), (a, c, d)] if short else [(a, b, d), (b, c, d)]
                self.triangles += [t[::-1] if inward else t for t in quad]
        return grid[0], grid[-1]

    def cap(self, rim, outward, spacing, name=None, hole=None):
        """Fills the plane inside `rim` (and outside `hole`) with triangles whose normals look along `outward`."""
        p = np.array([self.points[i] for i in rim])
        centre = p.mean(axis=0)
        z = outward / np.linalg.norm(outward)
        x = np.cross(z, [0.3, 0.5, 0.7])
        x /= np.linalg.norm(x)
        y = np.cross(z, x)
        to2 = lambda q: np.stack([(q - centre) @ x, (q - centre) @ y], axis=1)
        outer = to2(p)
        holes = to2(np.array([self.points[i] for i in hole])) if hole else np.zeros((0, 2))
        reach = np.abs(outer).max()
        n = int(reach / spacing) + 2
        inner = []
        for i in range(-n, n + 1):
            for j in range(-n, n + 1):
                q = spacing * (np.array([i + 0.5 * (j % 2), 0.866 * j]) + 0.12 * rng.uniform(-1, 1, 2) + [0.21, 0.13])
                clear = 0.62 * spacing
                if inside(q, outer) and gap(q, outer) > clear and not (hole and (inside(q, holes) or gap(q, holes) < clear)):
                    inner.append(q)
        inner = np.array(inner).reshape(-1, 2)
        added = self.add([centre + q[0] * x + q[1] * y for q in inner])
        index = list(rim) + list(hole or []) + added
        flat = np.concatenate([outer, holes, inner])
        first = len(self.triangles)
        for t in Delaunay(flat).simplices:
            a, b, c = flat[t]
            area = np.cross(b - a, c - a)
            middle = (a + b + c) / 3
            if abs(area) < 1e-9 or not inside(middle, outer) or (hole and inside(middle, holes)):
                continue
            self.triangles.append(tuple(index[k] for k in (t if area > 0 else t[::-1])))
        if name:
            self.faces.append((name, list(range(first, len(self.triangles)))))

    def write(self, folder, name):
        v, f = np.array(self.points), np.array(self.triangles)
        sides = {}
        for t in f:
            for a, b in zip(t, np.roll(t, -1)):
                assert (a, b) not in sides, (name, "an edge twice in one direction")
                sides[(a, b)] = 1
        assert all((b, a) in sides for a, b in sides), (name, "open")
        volume = np.einsum("ij,ij->", v[f[:, 0]], np.cross(v[f[:, 1]], v[f[:, 2]])) / 6
        assert volume > 0
        assert len(np.unique(f)) == len(v)
        with open(f"{folder}/{name}.obj", "w") as out:
            out.write(f"# {name}: {len(v)} vertices {len(f)} triangles\n")
            out.writelines("v %.9f %.9f %.9f\n" % tuple(p) for p in v)
            out.writelines("f %d %d %d\n" % tuple(t + 1) for t in f)
        faces = []
        for label, triangles in self.faces:
            t = f[triangles]
            twice = np.cross(v[t[:, 1]] - v[t[:, 0]], v[t[:, 2]] - v[t[:, 0]])
            area = 0.5 * np.linalg.norm(twice, axis=1)
            origin = (area[:, None] * v[t].mean(axis=1)).sum(axis=0) / area.sum()
            z = twice.sum(axis=0) / np.linalg.norm(twice.sum(axis=0))
            axis = 0
            for k in (1, 2):
                if abs(z[k]) < abs(z[axis]) - 1e-6:
                    axis = k
            e = np.eye(3)[axis]
            x = e - z @ e * z
            x /= np.linalg.norm(x)
            assert np.abs((v[np.unique(t)] - origin) @ z).max() < 3e-9
            faces.append({"name": label, "origin": origin.tolist(), "normal": z.tolist(), "x_axis": x.tolist(), "y_axis": np.cross(z, x).tolist(),
                          "vertices": np.unique(t).tolist(), "triangles": list(map(int, triangles)), "area": float(area.sum())})
        with open(f"{folder}/{name}.faces.json", "w") as out:
            json.dump({"mesh": f"{name}.obj", "index_base": 0, "faces": faces}, out)
        e = v[f] - v[np.roll(f, -1, axis=1)]
        length = np.linalg.norm(e, axis=2)
        height = 2 * 0.5 * np.linalg.norm(np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]]), axis=1) / length.max(axis=1)
        print(name, len(v), "vertices", len(f), "triangles, volume %.4f, worst aspect %.1f" % (volume, (length.max(axis=1) / height).max()))


def inside(q, polygon):
    a, b = polygon, np.roll(polygon, -1, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        hit = ((a[:, 1] > q[1]) != (b[:, 1] > q[1])) & (q[0] < (b[:, 0] - a[:, 0]) * (q[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) + a[:, 0])
    return hit.sum() % 2 == 1


def gap(q, polygon):
    a, d = polygon, np.roll(polygon, -1, axis=0) - polygon
    s = np.clip(((q - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0, 1)
    return np.linalg.norm(a + s[:, None] * d - q, axis=1).min()


def polygon_path(corners, counts):
    """A path around a polygon with counts[k] steps along side k: t in 0...1 to a point; and which steps are corners."""
    steps = np.concatenate([[0], np.cumsum(counts)])
    total = steps[-1]

    def at(t):
        u = (t * total) % total
        k = min(np.searchsorted(steps, u, side="right") - 1, len(counts) - 1)
        w = (u - steps[k]) / counts[k]
        return (1 - w) * corners[k] + w * corners[(k + 1) % len(corners)]

    return at, total, set(steps[:-1].tolist())


def bar(corners, counts, length, rings, spacing):
    body = Body()
    at, around, fixed = polygon_path(np.array(corners, float), counts)
    first, last = body.loft(lambda s, t: np.array([*at(t), length * (s - 0.5)]), rings, around, loose_t=lambda j: j not in fixed)
    body.cap(first, np.array([0, 0, -1.0]), spacing, "bottom")
    body.cap(last, np.array([0, 0, 1.0]), spacing, "top")
    return body


def prism(fine):
    a, b = (9, 11) if fine else (4, 5)
    return bar([[-0.4, -0.5], [0.4, -0.5], [0.4, 0.5], [-0.4, 0.5]], [a, b, a, b], 3.0, 43 if fine else 21, 0.1 if fine else 0.2)


def hexagon(fine):
    k = 7 if fine else 3
    angle = np.arange(6) * np.pi / 3
    return bar(0.6 * np.stack([np.cos(angle), np.sin(angle)], axis=1), [k] * 6, 2.4, 41 if fine else 22, 0.09 if fine else 0.19)


def tentacle(fine):
    """Radius 0.55 to 0.24 along an arc of 50 degrees, five bulges with creases between them."""
    body = Body()
    bend, length, bulges, per = np.radians(50), 3.2, 5, 12 if fine else 6
    around = 32 if fine else 16
    rings = bulges * per + 1

    def place(s, t):
        radius = (0.55 + (0.24 - 0.55) * s) * (0.8 + 0.2 * abs(np.sin(np.pi * bulges * s)))
        turn, arc = bend * s, length / bend
        centre = np.array([arc * np.sin(turn), arc * (1 - np.cos(turn)), 0])
        out = np.array([-np.sin(turn), np.cos(turn), 0])
        angle = 2 * np.pi * t
        return centre + radius * (np.cos(angle) * out + np.sin(angle) * np.array([0, 0, 1.0]))

    first, last = body.loft(place, rings, around, loose_s=lambda i: i % per != 0)
    body.cap(first, np.array([-1.0, 0, 0]), 0.09 if fine else 0.18, "root")
    body.cap(last, np.array([np.cos(bend), np.sin(bend), 0]), 0.04 if fine else 0.08, "tip")
    return body


def bulges(count, thin, thick, half, rings, around, spacing):
    """A straight row of bulges that leave the joint planes, and meet each other, tangentially to the plane between them."""
    body = Body()
    per = (rings - 1) // count

    def place(s, t):
        w = 2 * ((s * count) % 1) - 1
        radius = thin + (thick - thin) * max(1 - w * w, 0) ** 0.75
        return np.array([radius * np.cos(2 * np.pi * t), radius * np.sin(2 * np.pi * t), half * count * (2 * s - 1)])

    first, last = body.loft(place, rings, around, loose_s=lambda i: i % per != 0, shake=0.15)
    body.cap(first, np.array([0, 0, -1.0]), spacing, "bottom")
    body.cap(last, np.array([0, 0, 1.0]), spacing, "top")
    return body


def barrel(fine):
    return bulges(1, 0.8, 1.35, 1.0, 33 if fine else 17, 56 if fine else 27, 0.13 if fine else 0.26)


def caterpillar(fine):
    return bulges(3, 0.5, 0.75, 0.45, 49 if fine else 25, 38 if fine else 18, 0.095 if fine else 0.19)


def fin(fine, two_faces):
    """A swept blade: its section is a lens that ends in sharp edges, its tip is cut off."""
    body = Body()
    half = 26 if fine else 13
    rings = 38 if fine else 18
    length, reach = 2.0, 2.06

    def place(s, t):
        x = length * s
        width = 0.62 * np.sqrt(1 - (x / reach) ** 2) if not two_faces else 0.6 - 0.25 * s
        thick = 0.11 * (1 - 0.6 * s) if not two_faces else 0.10 - 0.04 * s
        u = (2 * t) % 2
        c = -1 + 2 * u if u <= 1 else 3 - 2 * u
        c = np.sin(0.5 * np.pi * c) * 0.45 + 0.55 * c  # closer towards the edges
        z = thick * (1 - c * c) * (1 if u <= 1 else -1)
        return np.array([x, width * c + 0.35 * s * s, z])

    first, last = body.loft(place, rings, 2 * half, loose_t=lambda j: j % half != 0)
    # t runs from -y over +z: clockwise seen from +x.
    body.triangles = [t[::-1] for t in body.triangles]
    body.cap(first, np.array([-1.0, 0, 0]), 0.045 if fine else 0.09, "root")
    body.cap(last, np.array([1.0, 0, 0]), 0.03 if fine else 0.06, "tip" if two_faces else None)
    return body


def elbow_path(radius, bend, leg):
    """A straight leg, a quarter of a circle of radius `bend`, a straight leg."""
    arc = 0.5 * np.pi * bend
    total = 2 * leg + arc

    def place(s, t):
        w = s * total
        turn = np.clip((w - leg) / bend, 0, 0.5 * np.pi)
        along = np.array([np.cos(turn), np.sin(turn), 0])
        out = np.array([-np.sin(turn), np.cos(turn), 0])
        centre = np.array([bend * np.sin(turn), bend * (1 - np.cos(turn)), 0]) + (min(w - leg, 0) + max(w - leg - arc, 0)) * along
        angle = 2 * np.pi * t
        r = radius(s) if callable(radius) else radius
        return centre + r * (np.cos(angle) * out + np.sin(angle) * np.array([0, 0, 1.0]))

    return place


def elbow(fine):
    body = Body()
    first, last = body.loft(elbow_path(0.5, 1.0, 0.35), 43 if fine else 22, 42 if fine else 20)
    body.cap(first, np.array([-1.0, 0, 0]), 0.085 if fine else 0.17, "first")
    body.cap(last, np.array([0, 1.0, 0]), 0.085 if fine else 0.17, "second")
    return body


def hollow_elbow(fine):
    """The elbow with a closed cavity."""
    body = Body()
    first, last = body.loft(elbow_path(0.5, 1.0, 0.35), 37 if fine else 18, 36 if fine else 18)
    body.cap(first, np.array([-1.0, 0, 0]), 0.1 if fine else 0.2, "first")
    body.cap(last, np.array([0, 1.0, 0]), 0.1 if fine else 0.2, "second")
    # The cavity: radius 0.28, its ends cut off flat.
    first, last = body.loft(elbow_path(lambda s: 0.28, 1.0, 0.0), 23 if fine else 11, 22 if fine else 11, inward=True)
    body.cap(first, np.array([1.0, 0, 0]), 0.1 if fine else 0.2)
    body.cap(last, np.array([0, -1.0, 0]), 0.1 if fine else 0.2)
    return body


def bored_elbow(fine):
    """The elbow as a tube: its joint faces are rings."""
    body = Body()
    first, last = body.loft(elbow_path(0.5, 1.0, 0.35), 33 if fine else 17, 34 if fine else 17)
    first_in, last_in = body.loft(elbow_path(0.28, 1.0, 0.35), 33 if fine else 15, 22 if fine else 11, inward=True)
    body.cap(first, np.array([-1.0, 0, 0]), 0.075 if fine else 0.15, "first", first_in)
    body.cap(last, np.array([0, 1.0, 0]), 0.075 if fine else 0.15, "second", last_in)
    return body


if __name__ == "__main__":
    for name, make in [("b_prism", prism), ("g_hexagon", hexagon), ("d_tentacle", tentacle), ("f_fin", lambda fine: fin(fine, True)),
                       ("f_fin_one_face", lambda fine: fin(fine, False)), ("h_elbow", elbow), ("i_hollow_elbow", hollow_elbow), ("j_bored_elbow", bored_elbow),
                       ("k_caterpillar", caterpillar), ("l_barrel", barrel)]:
        for fine in (False, True):
            make(fine).write(sys.argv[1], name + ("_fine" if fine else "_coarse"))
