"""Standard scenes of contact of a few cells, S2 to S4: each function returns a scene and the meshes that it names.

Lengths and numbers are those of the reference inputs (y is up); activation distances and speeds of friction are given
there as parts of the scene's diagonal.
"""

import math

from contact_scenes import shapes
from contact_scenes.parts import OUTPUT, body, box, contact, material, plane, simulation

# S2: Erleben 2018, collisions of units


def halves(quads):
    """Two triangles for each."""
    return [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]


def crack():
    """2 m x 1 m x 4 m with a V, 0.5 m deep, along its upper side."""
    heights = {-1.0: 0.5, -0.5: 0.5, 0.0: 0.0, 0.5: 0.5, 1.0: 0.5}
    n = len(heights)
    vertices = [[x, y, z] for z in (-2.0, 2.0) for x, top in heights.items() for y in (-0.5, top)]
    quads = [(0, 2 * n, 2 * n + 1, 1), (2 * n - 2, 2 * n - 1, 4 * n - 1, 4 * n - 2)]  # the ends along x
    for i in range(0, 2 * n - 2, 2):
        j = i + 2 * n
        quads += [
            (i, i + 1, i + 3, i + 2),
            (j, j + 2, j + 3, j + 1),
            (i, i + 2, j + 2, j),
            (i + 1, j + 1, j + 3, i + 3),
        ]
    return vertices, halves(quads), []


def hole():
    """The upper side of a block of 2 m x 2 m with a pit of 1 m x 1 m, 0.5 m deep."""
    ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    vertices = [
        [scale * x, y, scale * z] for scale, y in ((1, -0.5), (1, 0.5), (0.5, 0.5), (0.5, 0.0)) for x, z in ring
    ]
    quads = [
        (4 * level + i, 4 * level + 4 + i, 4 * level + 4 + (i + 1) % 4, 4 * level + (i + 1) % 4)
        for level in range(3)
        for i in range(4)
    ]
    return vertices, halves([*quads, (12, 15, 14, 13), (0, 1, 2, 3)]), []


def cliff():
    """A pyramid without its top: 1.5 m wide below, 1 m above, 1 m high; the cube above it stands out by 0.5 m."""
    vertices = [[h * x, y, h * z] for h, y in ((0.75, -0.5), (0.5, 0.5)) for z in (-1, 1) for x in (-1, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, halves(quads), []


def internal_edges():
    """A plate of 2 m x 2 m whose upper side has vertices and edges below where the cube comes down."""
    vertices = [
        [-1, 0.5, -1], [0, 0.5, -1], [1, 0.5, -1], [1, 0.5, 0], [1, 0.5, 1], [0, 0.5, 1], [-1, 0.5, 1], [-1, 0.5, 0],
        [-0.5, 0.5, 0.5], [0.5, 0.5, 0.5],
    ]  # fmt: skip
    triangles = [
        (7, 0, 1), (1, 2, 3), (6, 5, 8), (5, 4, 9), (4, 3, 9), (8, 7, 6), (3, 1, 9), (9, 1, 5), (8, 5, 1), (7, 8, 1),
    ]  # fmt: skip
    return [list(map(float, v)) for v in vertices], triangles, []


OBSTACLES = {
    "spike": (lambda: shapes.surface(shapes.spike()), 3.0),
    "wedge": (lambda: shapes.surface(shapes.wedge()), 3.0),
    "crack": (crack, 0.0),
    "hole": (hole, 0.0),
    "cliff": (cliff, 0.5),
    "internal_edges": (internal_edges, 0.5),
}


def erleben(falling, obstacle, gap=0.1):
    """A body of few cells falls onto an obstacle of few triangles, for 2,000 steps."""
    below = {"spike": 3.0, "wedge": 3.0, "cube": 0.0}[falling]
    solid = {"spike": shapes.spike, "wedge": shapes.wedge}.get(falling)
    reach = 1e-3 * math.dist([0, 0, 0], [1, 3, 1])
    meshes = {}
    if solid:
        meshes["body.mesh"] = shapes.upside_down(solid())
        mesh = "body.mesh"
    else:
        reach = 1e-3 * math.sqrt(3)
        mesh = box([1, 1, 1], [1, 1, 1], [0.0, 0, -0.5] if obstacle == "cliff" else [-0.5, 0, -0.43])
    if obstacle == "plane":
        collider, top = plane("obstacle", [0, 0, 0], [0, 1, 0], reach, 1.0), 0.0
    else:
        shape, top = OBSTACLES[obstacle]
        meshes["obstacle.obj"] = shape()
        collider = {
            "name": "obstacle",
            "kind": "mesh",
            "mesh": "obstacle.obj",
            "activation_distance": reach,
            "friction": 1.0,
        }
    scene = {
        "simulation": simulation(5e-3, 10),
        "body": [body(falling, mesh, material("corotated", 1e5), translate=[0, top + below + gap, 0])],
        "collider": [collider],
        "contact": contact(reach),
        "output": {**OUTPUT, "every": 40},
    }
    return scene, meshes


# S3: a few cells


def tet_on_tet():
    """The second falls 0.1 m onto the first, which falls onto the floor; its lower side covers the other's tip."""
    reach = 1e-3 * math.dist([0, 0, 0], [1, 2.1, 1])
    scene = {
        "simulation": simulation(0.025, 5),
        "body": [
            body(name, "tet.mesh", material("corotated", 1e5), translate=[0, height, 0])
            for name, height in (("lower", 2 * reach), ("upper", 1.1))
        ],
        "collider": [plane("floor", [0, 0, 0], [0, 1, 0], reach)],
        "contact": contact(reach),
        "output": OUTPUT,
    }
    return scene, {"tet.mesh": shapes.tetrahedron()}


def tet_in_slot(clearance=5e-7, reach=1e-6):
    """It falls between three blocks with next to no clearance onto a plane."""
    blocks = {"left": [-0.5 - clearance, 0, 0.5], "behind": [0.5, 0, -0.505], "right": [1.5 + clearance, 0, 0.5]}
    scene = {
        "simulation": simulation(0.025, 2.5),
        "body": [body("tet", "tet.mesh", material("corotated", 1e5))],
        "collider": [plane("floor", [0, -0.5, 0], [0, 1, 0], reach)]
        + [
            {"name": name, "kind": "box", "center": center, "size": [1, 1, 1], "activation_distance": reach}
            for name, center in blocks.items()
        ],
        "contact": contact(reach),
        "output": OUTPUT,
    }
    return scene, {"tet.mesh": shapes.tetrahedron()}


def cube_stack(count=5):
    """Cubes of 6 cells, without friction."""
    reach = 1e-3 * math.dist([0, 0, 0], [1, 1.01 * count, 1])
    scene = {
        "simulation": simulation(0.025, 5),
        "body": [
            body(f"cube {i + 1}", box([1, 1, 1], [1, 1, 1], [-0.5, 0.01 + 1.01 * i, -0.5]), material("corotated", 1e5))
            for i in range(count)
        ],
        "collider": [plane("floor", [0, 0, 0], [0, 1, 0], reach)],
        "contact": contact(reach),
        "output": OUTPUT,
    }
    return scene, {}


def mass_ratio():
    """S4: a cube of 10 m and 10^7 kg falls onto one of 1 m and 1,000 kg."""
    reach = 1e-3 * math.dist([0, 0, 0], [10, 12, 10])
    scene = {
        "simulation": simulation(0.025, 3),
        "body": [
            body("large", box([10, 10, 10], [1, 1, 1], [-5, 2, -5]), material("neo_hookean", 1e8, 1e4)),
            body("small", box([1, 1, 1], [1, 1, 1], [-0.5, 0.5, -0.5]), material("neo_hookean", 1e6)),
        ],
        "collider": [plane("floor", [0, 0, 0], [0, 1, 0], reach, 0.5)],
        "contact": contact(reach, friction=0.5),
        "output": OUTPUT,
    }
    return scene, {}
