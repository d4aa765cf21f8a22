"""Standard scenes of contact, S5 to S14: each function returns a scene and the meshes that it names.

Lengths and numbers are those of the reference inputs (y is up); activation distances and speeds of friction are given
there as parts of the scene's diagonal.
"""

import math

from contact_scenes import shapes
from contact_scenes.parts import OUTPUT, body, box, contact, material, plane, simulation


def rods_twist(time_step, law="neo_hookean", cells=(16, 2, 2), end_time=6):
    """S8: four rods, 1 m long, both ends turned at 72 degrees per second against each other, without gravity."""
    reach = 1e-3 * math.dist([0, 0, 0], [1, 0.35, 0.35])
    width = 0.15

    def turn(name, rod, group, degrees):
        return {
            "name": f"{name} {rod}",
            "body": rod,
            "where": {"group": group},
            "rotate": {"axis": [1, 0, 0], "center": [0, 0, 0], "degrees": degrees},
            "time_function": {"table": [[0, 0], [end_time, 1]]},
        }

    rods = {f"rod {i + 1}": (y, z) for i, (y, z) in enumerate([(-0.1, -0.1), (-0.1, 0.1), (0.1, -0.1), (0.1, 0.1)])}
    scene = {
        "simulation": simulation(time_step, end_time, [0, 0, 0]),
        "body": [
            body(name, box([1, width, width], list(cells), [-0.5, y - width / 2, z - width / 2]), material(law, 1e4))
            for name, (y, z) in rods.items()
        ],
        "fix": [turn("left", rod, "x_min", -72 * end_time) for rod in rods]
        + [turn("right", rod, "x_max", 72 * end_time) for rod in rods],
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": max(1, round(0.1 / time_step))},
    }
    return scene, {}


def thrown_ball(
    radius, speed, youngs_modulus, poissons_ratio, density, time_step, end_time, integrator, reach, parts=4
):
    """S12: a ball flies at a wall."""
    reach *= 2 * radius * math.sqrt(3)
    thrown = body(
        "ball", "ball.mesh", material("neo_hookean", youngs_modulus, density, poissons_ratio), velocity=[speed, 0, 0]
    )
    scene = {
        "simulation": simulation(time_step, end_time, [0, 0, 0], integrator=integrator),
        "body": [thrown],
        "collider": [plane("wall", [1.1 * radius, 0, 0], [-1, 0, 0], reach)],
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {"ball.mesh": shapes.ball(radius, parts)}


def pencil():
    """S13: the upper end of a soft rod is pulled along at 0.15 m/s; the lower one drags over the floor."""
    length, width = 0.1, 0.004
    reach = 1e-3 * length
    rod = body(
        "rod",
        box([width, length, width], [2, 48, 2], [-width / 2, 1.5 * reach, -width / 2]),
        material("neo_hookean", 1e5),
    )
    scene = {
        "simulation": simulation(1e-3, 2),
        "body": [rod],
        "fix": [
            {
                "name": "hand",
                "where": {"vertices": [48 * 3]},
                "velocity": [-0.15, 0, 0],
            }
        ],
        "collider": [plane("floor", [0, 0, 0], [0, 1, 0], reach, 0.35)],
        "contact": contact(reach, 1e-6 * length, self=True),
        "probe": [{"name": "tip", "at": [width / 2, 0, width / 2]}],
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {}


# S5: masonry

ARCH_HEIGHT, ARCH_HALF_SPAN, ARCH_RATE = 60.0, 30.0, 1.34  # the line through the middle of the joints: a catenary
ARCH_SIDES = (100.0, 49.0)  # area of a joint at the foot and at the crown


def arch_line(x):
    """Place and direction of the arch's middle line above x."""
    rate = ARCH_RATE / ARCH_HALF_SPAN
    factor = ARCH_HEIGHT / (math.cosh(ARCH_RATE) - 1)
    y = ARCH_HEIGHT - factor * (math.cosh(rate * x) - 1)
    slope = -factor * rate * math.sinh(rate * x)
    length = math.hypot(1, slope)
    return (x, y), (1 / length, slope / length)


def arch_joints(count):
    """x of the joints between blocks of equal length."""
    fine = 4000
    xs = [ARCH_HALF_SPAN * (2 * i / fine - 1) for i in range(fine + 1)]
    lengths = [0.0]
    for a, b in zip(xs, xs[1:], strict=False):
        lengths.append(lengths[-1] + math.dist(arch_line(a)[0], arch_line(b)[0]))
    found, k = [], 0
    for joint in range(count + 1):
        wanted = lengths[-1] * joint / count
        while k < fine - 1 and lengths[k + 1] < wanted:
            k += 1
        part = (wanted - lengths[k]) / (lengths[k + 1] - lengths[k])
        found.append(xs[k] + part * (xs[k + 1] - xs[k]))
    return found


def arch_blocks(count, gap):
    """Blocks with joints across the line; the feet stand on y = 0. Neighbours start `gap` apart, the crown highest."""
    joints = arch_joints(count)
    blocks = []
    for number, (left, right) in enumerate(zip(joints, joints[1:], strict=False)):
        middle_height = max(arch_line((left + right) / 2)[0][1], 0)
        side = math.sqrt(ARCH_SIDES[0] + (ARCH_SIDES[1] - ARCH_SIDES[0]) * middle_height / ARCH_HEIGHT)
        corners = []
        for z in (-side / 2, side / 2):
            for off in (-side / 2, side / 2):
                for x in (left, right):
                    (px, py), (tx, ty) = arch_line(x)
                    corner = [px - off * ty, py + off * tx, z]
                    if x in (joints[0], joints[-1]):  # along the block to the ground
                        corner = [corner[0] - corner[1] * tx / ty, 0.0, z]
                    corners.append(corner)
        away = number - count // 2
        blocks.append(shapes.moved(shapes.hexahedron(corners), [gap * away, gap * (count // 2 - abs(away) + 1), 0]))
    return blocks


def arch(friction, youngs_modulus=2e10, end_time=20, count=25, reach=5e-8, gap=0.1, time_step=0.01):
    """S5: 25 blocks on two feet; the thrust leans at 12.6 degrees on the ground, which takes a friction of 0.22."""
    scale = 20 / 82
    diagonal = 27.2
    stone = material("corotated", youngs_modulus, 2300, 0.2)
    meshes = {
        f"block_{i + 1:02}.mesh": shapes.moved(block, scale=scale) for i, block in enumerate(arch_blocks(count, gap))
    }
    scene = {
        "simulation": simulation(time_step, end_time),
        "body": [body(file.removesuffix(".mesh"), file, stone) for file in meshes],
        "collider": [plane("ground", [0, 0, 0], [0, 1, 0], reach * diagonal, friction)],
        "contact": contact(reach * diagonal, 1e-5 * diagonal, friction=friction),
        "probe": [{"name": "crown", "body": f"block_{count // 2 + 1:02}", "at": [0, ARCH_HEIGHT * scale, 0]}],
        "output": {**OUTPUT, "every": 10},
    }
    return scene, meshes


# S6: cards


def two_cards(friction, degrees=75, cells=5, end_time=5):
    """Two mats lean against each other; they stand where friction is above cos / (2 sin) of their angle: 0.134."""
    diagonal, thickness = math.dist([0, 0, 0], [0.6, 1, 1]), 0.008
    reach = 1e-3 * diagonal
    angle = math.radians(degrees)
    # Turned about their lower edge; the upper ones start 2 reach apart.
    foot = math.cos(angle) + thickness / 2 * math.sin(angle) + reach

    def card(name, side):
        size = [1, thickness, 1]
        return body(
            name,
            box(size, [cells, 1, cells], [0, -thickness / 2, -0.5]),
            material("corotated", 1e8),
            rotate=[0, 0, 1, degrees if side < 0 else 180 - degrees],
            translate=[side * foot, thickness / 2 * math.cos(angle) + reach, 0],
        )

    scene = {
        "simulation": simulation(0.025, end_time),
        "body": [card("left", -1), card("right", 1)],
        "collider": [plane("floor", [0, 0, 0], [0, 1, 0], reach, friction)],
        "contact": contact(reach, 1e-5 * diagonal, friction=friction),
        "probe": [{"name": "ridge", "body": "left", "at": [-foot + math.cos(angle), math.sin(angle), 0]}],
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {}


# S9 to S11: led through and pressed


def rollers(parts=4, end_time=10, time_step=0.01):
    """S9: a ball is drawn through two pairs of cylinders, one across the other."""
    reach = 1e-3 * 2
    radius = 0.15

    def roller(name, start, end, axis, speed):
        return {
            "name": name,
            "kind": "cylinder",
            "start": start,
            "end": end,
            "radius": radius,
            "friction": 0.5,
            "activation_distance": reach,
            "rotate": {"axis": axis, "center": start, "degrees_per_second": speed},
        }

    scene = {
        "simulation": simulation(time_step, end_time),
        "body": [body("ball", "ball.mesh", material("neo_hookean", 1e4), translate=[0, 0.42, 0])],
        "collider": [
            roller("upper left", [-0.25, 0, -0.5], [-0.25, 0, 0.5], [0, 0, 1], -90),
            roller("upper right", [0.25, 0, -0.5], [0.25, 0, 0.5], [0, 0, 1], 90),
            roller("lower front", [-0.5, -0.5, -0.25], [0.5, -0.5, -0.25], [1, 0, 0], 90),
            roller("lower back", [-0.5, -0.5, 0.25], [0.5, -0.5, 0.25], [1, 0, 0], -90),
            plane("floor", [0, -1.5, 0], [0, 1, 0], reach),
        ],
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": 20},
    }
    return scene, {"ball.mesh": shapes.ball(0.25, parts)}


SPOT = shapes.HERE.parent.parent / "data" / "spot_rough.msh"


def compactor(until=0.49, end_time=1.0):
    """S10: six planes close upon Spot at 1 m/s, until it has one and a half times its volume."""
    reach = 1e-3 * math.sqrt(3)
    planes = []
    for axis, name in enumerate("xyz"):
        for sign in (-1, 1):
            normal = [0, 0, 0]
            normal[axis] = -sign
            wall = plane(f"{name}{'-+'[sign > 0]}", [-n for n in normal], normal, reach)
            planes.append({**wall, "velocity": normal, "until": until})
    scene = {
        "simulation": simulation(0.01, end_time, [0, 0, 0]),
        "body": [body("spot", str(SPOT), material("corotated", 1e4), translate=[0, -0.1065, -0.186])],
        "collider": planes,
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": 10},
    }
    return scene, {}


# S14: narrow and thin things


def tunnel(clearance=1e-4):
    """A stiff cube flies at 10 m/s between four planes that it just fits between."""
    reach = 1e-2 * math.sqrt(3)
    walls = []
    for axis, name in ((1, "y"), (2, "z")):
        for sign in (-1, 1):
            normal = [0, 0, 0]
            normal[axis] = -sign
            walls.append(plane(f"{name}{'-+'[sign > 0]}", [-n * (0.5 + clearance) for n in normal], normal, reach))
    flying = body(
        "cube", box([1, 1, 1], [2, 2, 2], [-0.5, -0.5, -0.5]), material("neo_hookean", 1e11), velocity=[10, 0, 0]
    )
    scene = {
        "simulation": simulation(0.01, 1, [0, 0, 0]),
        "body": [flying],
        "collider": walls,
        "contact": contact(reach),
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {}


def chain(links=5, around=20, across=2, end_time=5):
    """Rings hang in each other; the first is held."""
    radius, tube = 0.2, 0.05
    pitch = 2 * (radius - tube) - 0.02
    reach = 1e-3 * 2
    # A ring lies about y: on edge about x, and every second one about z.
    turns = ([1, 0, 0, 90], [0, 0, 1, 90])
    rings = [
        body(
            f"link {i + 1}",
            "ring.mesh",
            material("neo_hookean", 1e7, 500),
            rotate=turns[i % 2],
            translate=[0, -pitch * i, 0],
        )
        for i in range(links)
    ]
    scene = {
        "simulation": simulation(0.04, end_time),
        "body": rings,
        "fix": [
            {"name": "hook", "body": "link 1", "where": {"sphere": {"center": [0, radius, 0], "radius": 1.1 * tube}}}
        ],
        "contact": contact(reach),
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {"ring.mesh": shapes.torus(radius, tube, around, across)}


def knives(cells=20, end_time=6):
    """A mat falls onto nine upright triangles, which have no thickness."""
    reach = 1e-3 * 1.5
    blades = [[0.2 * i - 0.4, 0, -0.5] for i in range(5)] + [[0.2 * i - 0.3, 0, 0.5] for i in range(4)]
    vertices, triangles = [], []
    for x, y, z in blades:
        first = len(vertices)
        sign = 1 if z < 0 else -1
        vertices += [[x, y, z], [x, y + 0.6, z], [x, y, z + sign * 1.0]]
        triangles.append((first, first + 1, first + 2))
    scene = {
        "simulation": simulation(0.04, end_time),
        "body": [
            body("mat", box([1, 0.02, 1], [cells, 1, cells], [-0.5, 0.7, -0.5]), material("neo_hookean", 2e4)),
        ],
        "collider": [
            {"name": "knives", "kind": "mesh", "mesh": "knives.obj", "activation_distance": reach},
            plane("floor", [0, 0, 0], [0, 1, 0], reach),
        ],
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {"knives.obj": (vertices, triangles, [])}


def point_bed(parts=4, end_time=2):
    """A ball of 5 m falls onto 20 x 21 points."""
    reach = 1e-3 * 10
    vertices = [[0.5 * i - 4.75, 0.0, 0.5 * j - 5.0] for i in range(20) for j in range(21)]
    scene = {
        "simulation": simulation(0.04, end_time),
        "body": [body("ball", "ball.mesh", material("neo_hookean", 1e5), translate=[0.1, 2.7, 0.05])],
        "collider": [
            {"name": "points", "kind": "mesh", "mesh": "points.obj", "activation_distance": reach},
        ],
        "contact": contact(reach, self=True),
        "output": {**OUTPUT, "every": 5},
    }
    return scene, {"ball.mesh": shapes.ball(2.5, parts), "points.obj": (vertices, [], list(range(len(vertices))))}
