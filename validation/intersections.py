"""Whether things share space in the saved frames of a run: found by exact predicates, in another way than contact does.

Triangles of surfaces that an edge passes through, parts inside of closed surfaces, vertices inside of planes and
cylinders; of colliders of the scene as of bodies.
"""

import collections
import itertools
import math
import re
import tomllib
from fractions import Fraction

from contact_scenes import shapes
from frames import read_frame

ROUNDING = 8e-16  # rounding of a sum of products of three differences (Shewchuk 1997, o3derrboundA)
ROLLER_SIDES = 64  # roller sides of a cylinder, docs/contact.md: its facets are inside the circle
IN_A_BODY = 0.5  # winding number above which a point is inside


def side(a, b, c, d):
    """Sign of the volume of a, b, c, d: exact."""
    u, v, w = ([x - y for x, y in zip(p, d, strict=True)] for p in (a, b, c))
    products = [
        (w[2], u[0], v[1]),
        (w[2], -v[0], u[1]),
        (u[2], v[0], w[1]),
        (u[2], -w[0], v[1]),
        (v[2], w[0], u[1]),
        (v[2], -u[0], w[1]),
    ]
    terms = [x * y * z for x, y, z in products]
    value = sum(terms)
    if abs(value) <= ROUNDING * sum(map(abs, terms)):
        rows = [[Fraction(x) - Fraction(y) for x, y in zip(p, d, strict=True)] for p in (a, b, c)]
        value = shapes.determinant(*rows)
    return (value > 0) - (value < 0)


def passes_through(p, q, a, b, c):
    """Whether the segment p q meets the triangle a b c; not where all five are in one plane."""
    above, below = side(a, b, c, p), side(a, b, c, q)
    if above == below:
        return False
    turns = {side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)}
    return not {1, -1} <= turns


class Cells:
    """Boxes in the cells of a grid that they reach."""

    def __init__(self, boxes):
        self.boxes = boxes
        sizes = [high - low for low, high in itertools.chain.from_iterable(boxes)]
        self.width = 2 * math.fsum(sizes) / len(sizes) or 1.0
        self.table = collections.defaultdict(list)
        for number, box in enumerate(boxes):
            for cell in self.cells_of(box):
                self.table[cell].append(number)

    def cells_of(self, box):
        return itertools.product(
            *(range(math.floor(low / self.width), math.floor(high / self.width) + 1) for low, high in box)
        )

    def near(self, box):
        found = {number for cell in self.cells_of(box) for number in self.table.get(cell, ())}
        return [
            number
            for number in found
            if all(lo <= b and hi >= a for (lo, hi), (a, b) in zip(self.boxes[number], box, strict=True))
        ]


def box_of(points):
    return [(min(column), max(column)) for column in zip(*points, strict=True)]


def edges_of(triangles):
    return {tuple(sorted(pair)) for a, b, c in triangles for pair in ((a, b), (b, c), (c, a))}


def crossings(vertices, triangles, first_rigid):
    """How many pairs of an edge and a triangle without a common vertex meet.

    Vertices from `first_rigid` on are those of colliders, which do not meet each other.
    """
    cells = Cells([box_of([vertices[i] for i in triangle]) for triangle in triangles])
    count = 0
    for i, j in edges_of(triangles):
        p, q = vertices[i], vertices[j]
        for number in cells.near(box_of([p, q])):
            triangle = triangles[number]
            if i >= first_rigid and triangle[0] >= first_rigid:
                continue
            if i not in triangle and j not in triangle:
                count += passes_through(p, q, *(vertices[k] for k in triangle))
    return count


def dot(u, v):
    return sum(x * y for x, y in zip(u, v, strict=True))


def winding_number(point, vertices, triangles):
    """1 inside of a closed surface, 0 outside (van Oosterom & Strackee 1983)."""
    total = 0.0
    for triangle in triangles:
        a, b, c = (shapes.subtract(vertices[i], point) for i in triangle)
        la, lb, lc = math.hypot(*a), math.hypot(*b), math.hypot(*c)
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        total += math.atan2(shapes.determinant(a, b, c), below)
    return total / (2 * math.pi)


def parts_of(triangles):
    """Triangles of each connected surface."""
    parent = {i: i for triangle in triangles for i in triangle}

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b, c in triangles:
        parent[root(a)] = parent[root(b)] = root(c)
    parts = collections.defaultdict(list)
    for triangle in triangles:
        parts[root(triangle[0])].append(triangle)
    return list(parts.values())


def is_closed(triangles):
    directed = {pair for a, b, c in triangles for pair in ((a, b), (b, c), (c, a))}
    return all((b, a) in directed for a, b in directed)


def swallowed(vertices, triangles, points):
    """How many connected parts, and loose points, are inside of another part that is closed."""
    parts = parts_of(triangles)
    boxes = [box_of([vertices[i] for triangle in part for i in triangle]) for part in parts]
    probes = [(vertices[part[0][0]], number) for number, part in enumerate(parts)] + [
        (vertices[i], None) for i in points
    ]
    count = 0
    for (point, own), (number, part) in itertools.product(probes, enumerate(parts)):
        in_box = all(low <= x <= high for x, (low, high) in zip(point, boxes[number], strict=True))
        if own != number and in_box and is_closed(part):
            count += abs(winding_number(point, vertices, part)) > IN_A_BODY
    return count


def way(collider, time):
    """How far a collider has been moved; no scene turns one that is not round about its own axis."""
    until = min(time, collider.get("until", math.inf))
    return [v * until for v in collider.get("velocity", [0, 0, 0])]


def facets_of(collider, folder, time):
    """(vertices, triangles, loose points) of a box or a mesh, or None."""
    if collider["kind"] == "mesh":
        shape = shapes.moved(
            shapes.read_surface(folder / collider["mesh"]),
            collider.get("translate", [0, 0, 0]),
            collider.get("scale", 1.0),
        )
    elif collider["kind"] == "box":
        corner = [c - s / 2 for c, s in zip(collider["center"], collider["size"], strict=True)]
        corners = [[x + (i >> axis & 1) * collider["size"][axis] for axis, x in enumerate(corner)] for i in range(8)]
        shape = shapes.surface(shapes.hexahedron(corners))
    else:
        return None
    return shapes.moved(shape, way(collider, time))


def vertices_inside(collider, time, positions):
    """Surface points of a half-space, a sphere or a long cylinder."""
    shift = way(collider, time)
    if collider["kind"] == "half_space":
        point = [x + s for x, s in zip(collider["point"], shift, strict=True)]
        return sum(
            sum(n * (x - p) for n, x, p in zip(collider["normal"], v, point, strict=True)) <= 0 for v in positions
        )
    if collider["kind"] == "sphere":
        center = [x + s for x, s in zip(collider["center"], shift, strict=True)]
        return sum(math.dist(v, center) <= collider["radius"] for v in positions)
    if collider["kind"] == "cylinder":
        start, end = collider["start"], collider["end"]
        axis = shapes.subtract(end, start)
        length = math.hypot(*axis)
        inner = collider["radius"] * math.cos(math.pi / ROLLER_SIDES)
        count = 0
        for v in positions:
            off = shapes.subtract(shapes.subtract(v, start), shift)
            along = sum(x * y for x, y in zip(off, axis, strict=True)) / length
            count += 0 <= along <= length and sum(x * x for x in off) - along * along <= inner * inner
        return count
    return 0


def steps_behind(folder):
    """Steps at whose end moving colliders are behind their motion, so that nothing tells where."""
    log = (folder / "log.txt").read_text(encoding="utf-8")
    return {int(step) for step in re.findall(r"\(step (\d+)\): bodies block a moving collider", log)}


def intersections(report, folder):
    """Crossings, parts inside of others and vertices inside of colliders, summed over all saved frames."""
    behind = steps_behind(folder)
    scene_folder = folder / "scene"
    scene = tomllib.loads((scene_folder / "scene.toml").read_text(encoding="utf-8"))
    return sum(
        intersections_of_frame(
            read_frame(folder, number), entry["time"], colliders_of(scene, entry["step"] in behind), scene_folder
        )
        for number, entry in enumerate(report["frames"])
    )


def colliders_of(scene, only_at_rest):
    return [c for c in scene.get("collider", []) if not (only_at_rest and "velocity" in c)]


def intersections_of_frame(frame, time, colliders, scene_folder):
    vertices, triangles, points = shapes.surface((list(frame.positions), frame.cells))
    first_rigid = len(vertices)
    on_surface = {i for triangle in triangles for i in triangle}
    count = 0
    for collider in colliders:
        facets = facets_of(collider, scene_folder, time)
        if facets is None:
            count += vertices_inside(collider, time, [vertices[i] for i in on_surface])
            continue
        first = len(vertices)
        vertices = vertices + facets[0]
        triangles = triangles + [tuple(first + i for i in triangle) for triangle in facets[1]]
        points = points + [first + i for i in facets[2]]
    return count + crossings(vertices, triangles, first_rigid) + swallowed(vertices, triangles, points)


def inverted_cells(report, folder):
    """Tetrahedra of volume zero or less, by exact predicates, summed over all saved frames."""
    count = 0
    for number in range(len(report["frames"])):
        frame = read_frame(folder, number)
        count += sum(side(*(frame.positions[i] for i in cell)) >= 0 for cell in frame.cells)
    return count
