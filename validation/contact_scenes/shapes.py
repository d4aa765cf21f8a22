"""Meshes of the contact scenes: solids of tetrahedra, surfaces of triangles, and how both are written.

A solid is a pair (vertices [m], tetrahedra of positive volume), a surface (vertices [m], triangles, loose points).
"""

import itertools
import math
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
KUHN = list(itertools.permutations(range(3)))  # each orders the three steps from a cube's first corner to its last


def subtract(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def determinant(a, b, c):
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def turned_out(vertices, tetrahedra):
    """The solid with every tetrahedron's vertices in the order that gives it a positive volume."""
    solid = []
    for a, b, c, d in tetrahedra:
        volume = determinant(*(subtract(vertices[i], vertices[a]) for i in (b, c, d)))
        solid.append((a, b, c, d) if volume > 0 else (a, c, b, d))
    return vertices, solid


def moved(solid, by=(0.0, 0.0, 0.0), scale=1.0):
    vertices, cells = solid[0], solid[1:]
    return ([[scale * x + shift for x, shift in zip(v, by, strict=True)] for v in vertices], *cells)


def upside_down(solid):
    """Turned by 180 degrees about x."""
    return ([[x, -y, -z] for x, y, z in solid[0]], *solid[1:])


def tetrahedron():
    """The unit corner, 1 m along each axis."""
    return turned_out([[0.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]], [(0, 1, 2, 3)])


def spike():
    """A pyramid on 1 m x 1 m, 3 m high, in two cells."""
    vertices = [[0.5, 0.0, -0.5], [0.5, 0.0, 0.5], [-0.5, 0.0, 0.5], [-0.5, 0.0, -0.5], [0.0, 3.0, 0.0]]
    return turned_out(vertices, [(0, 2, 3, 4), (1, 2, 4, 0)])


def wedge():
    """A roof on 1 m x 2 m, 3 m high, in three cells."""
    vertices = [
        [-0.5, 0.0, 1.0],
        [0.0, 3.0, 1.0],
        [-0.5, 0.0, -1.0],
        [0.0, 3.0, -1.0],
        [0.5, 0.0, 1.0],
        [0.5, 0.0, -1.0],
    ]
    return turned_out(vertices, [(0, 2, 3, 5), (4, 0, 1, 5), (1, 0, 3, 5)])


def hexahedron(corners):
    """Six cells between eight corners, x first, then y, then z."""
    cells = []
    for order in KUHN:
        path = [0]
        for axis in order:
            path.append(path[-1] + (1 << axis))
        cells.append(tuple(path))
    return turned_out(corners, cells)


def grid(counts, place, is_ring=False):
    """Cubes cut into six cells each; `place` puts (i, j, k) somewhere. A ring closes upon itself along i."""
    nx, ny, nz = counts
    layers = nx if is_ring else nx + 1
    indices = list(itertools.product(range(layers), range(ny + 1), range(nz + 1)))
    number = {index: n for n, index in enumerate(indices)}
    cells = []
    for start in itertools.product(range(nx), range(ny), range(nz)):
        for order in KUHN:
            corner, path = list(start), [start]
            for axis in order:
                corner[axis] += 1
                path.append((corner[0] % layers, corner[1], corner[2]))
            cells.append(tuple(number[tuple(index)] for index in path))
    return turned_out([place(*index) for index in indices], cells)


def ball(radius, parts):
    """20 parts^3 cells: those of an icosahedron, each cut by Freudenthal's grid and drawn onto spheres."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [v for a in (-1.0, 1.0) for b in (-golden, golden) for v in ([0, a, b], [a, b, 0], [b, 0, a])]
    faces = [
        face
        for face in itertools.combinations(range(12), 3)
        if all(math.dist(corners[i], corners[j]) < 2.1 for i, j in itertools.combinations(face, 2))
    ]  # edges are 2 long
    number, vertices, cells = {}, [], []

    def vertex(face, x, y, z):
        weights = {i: w for i, w in zip(face, (x - y, y - z, z), strict=True) if w}
        key = tuple(sorted(weights.items()))
        if key not in number:
            number[key] = len(vertices)
            place = [sum(w * corners[i][axis] for i, w in weights.items()) for axis in range(3)]
            length = math.hypot(*place) or 1.0
            vertices.append([radius * x / parts * c / length for c in place])
        return number[key]

    for face in faces:
        for start in itertools.product(range(parts), repeat=3):
            for order in KUHN:
                corner, path = list(start), [start]
                for axis in order:
                    corner[axis] += 1
                    path.append(tuple(corner))
                if all(parts >= x >= y >= z for x, y, z in path):
                    cells.append(tuple(vertex(face, *index) for index in path))
    return turned_out(vertices, cells)


def torus(radius, tube, around, across):
    """A ring about y with a round section, in 6 around across^2 cells."""

    def place(i, j, k):
        u, v = 2 * j / across - 1, 2 * k / across - 1
        # From the square to the disc: rings of the square become circles.
        size = max(abs(u), abs(v)) / (math.hypot(u, v) or 1.0)
        u, v = tube * u * size, tube * v * size
        angle = 2 * math.pi * i / around
        return [(radius + u) * math.cos(angle), v, (radius + u) * math.sin(angle)]

    return grid((around, across, across), place, is_ring=True)


def surface(solid):
    """Triangles that belong to one cell, seen anticlockwise from outside."""
    vertices, cells = solid
    sides = {}
    for a, b, c, d in cells:
        for side in ((a, c, b), (a, b, d), (b, c, d), (a, d, c)):
            sides.setdefault(tuple(sorted(side)), []).append(side)
    return vertices, [found[0] for found in sides.values() if len(found) == 1], []


def write_solid(file, solid):
    """Medit."""
    vertices, cells = solid
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(vertices))]
    lines += [" ".join(map(repr, map(float, v))) + " 0" for v in vertices]
    lines += ["Tetrahedra", str(len(cells))] + [" ".join(str(i + 1) for i in cell) + " 0" for cell in cells]
    file.write_text("\n".join([*lines, "End", ""]), encoding="utf-8")


def write_surface(file, shape):
    """Wavefront OBJ."""
    vertices, triangles, points = shape
    lines = ["v " + " ".join(map(repr, map(float, v))) for v in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in triangle) for triangle in triangles]
    lines += [f"p {i + 1}" for i in points]
    file.write_text("\n".join([*lines, ""]), encoding="utf-8")


def read_surface(file):
    vertices, triangles, points = [], [], []
    for line in file.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            triangles.append(tuple(int(word) - 1 for word in words[1:4]))
        elif words[:1] == ["p"]:
            points.append(int(words[1]) - 1)
    return vertices, triangles, points
