"""Scenes that run on several processes, for check_petsc.py."""

import dataclasses


@dataclasses.dataclass
class SharedScene:
    """A scene, on which numbers of processes it runs, and how many times the tolerance its numbers may be off."""

    name: str
    text: str
    ranks: tuple = (2,)
    slack: float = 1
    ties: bool = False  # several cells have the smallest volume ratio


HEAD = '[newton]\ntolerance = 1e-12\n[output]\nfields = ["displacement", "von_mises", "cauchy_stress"]\n'
STATIC = HEAD + '[simulation]\nkind = "static"\n'
CLAMP = '[[fix]]\nname = "wall"\nwhere = { plane = { axis = "x", at = 0 } }\n'
TIP = '[[probe]]\nname = "tip"\nat = [2, 0.5, 0.5]\n'


def box(element, law="neo_hookean", nu=0.3, more="", cells="[6, 3, 3]", body=""):
    return (
        f'[[body]]\nname = "bar"\nelement = "{element}"\n'
        f"mesh = {{ box = {{ size = [2, 1, 1], cells = {cells}{more} }} }}\n"
        f'material = {{ law = "{law}", youngs_modulus = 1e6, poissons_ratio = {nu}, density = 1000 }}\n{body}'
    )


def moving(integrator, end=0.06, more=""):
    return HEAD + (
        f'[simulation]\nkind = "dynamic"\ntime_step = 0.01\nend_time = {end}\nintegrator = "{integrator}"\n'
        f"gravity = [0, 0, -9.81]\n{more}"
    )


BENT = (
    '[[load]]\nname = "pull"\nkind = "traction"\nwhere = { plane = { axis = "x", at = 2 } }\nvalue = [0, 2e4, -3e4]\n'
)
PRESSED = '[[load]]\nname = "gas"\nkind = "pressure"\nwhere = { plane = { axis = "z", at = 0 } }\nvalue = -6e3\n'
HUNG = (
    '[[load]]\nname = "rope"\nkind = "nodal_force"\nwhere = { plane = { axis = "x", at = 2 } }\nvalue = [0, 0, -300]\n'
    '[[load]]\nname = "spring"\nkind = "spring"\nwhere = { plane = { axis = "y", at = 1 } }\nstiffness = 2e3\n'
    '[[load]]\nname = "wind"\nkind = "body_force"\nwhere = { box = [[0, 0, 0], [1, 1, 1]] }\nvalue = [0, 3000, 0]\n'
)
TURN = (
    '[[fix]]\nname = "turn"\nwhere = { plane = { axis = "x", at = 2 } }\n'
    "rotate = { axis = [1, 0, 0], center = [0, 0.5, 0.5], degrees = 60 }\n"
)
GROUND = (
    '[[collider]]\nname = "ground"\nkind = "half_space"\npoint = [0, 0, -0.05]\nnormal = [0, 0, 1]\n'
    "activation_distance = 0.05\n"
    '[[collider]]\nname = "ball"\nkind = "sphere"\ncenter = [1, 0.5, 21.06]\nradius = 20\n'
    "activation_distance = 0.05\nvelocity = [0, 0, -2]\nuntil = 0.03\n"
)
FREE = "velocity = [1, 0, 3]\nvelocity_gradient = [[0, 0, 2], [0, 0, 0], [-2, 0, 0]]\n"
FLAT = HEAD + (
    '[simulation]\nkind = "static"\ndimension = 2\n'
    '[[body]]\nname = "sheet"\nelement = "Q1"\n'
    'mesh = { box = { size = [2, 1], cells = [12, 6], kind = "quadrilaterals" } }\n'
    'material = { law = "saint_venant_kirchhoff", youngs_modulus = 1e6, poissons_ratio = 0.3 }\n'
    '[[fix]]\nname = "wall"\nwhere = { plane = { axis = "x", at = 0 } }\n'
    '[[load]]\nname = "pull"\nkind = "traction"\nwhere = { plane = { axis = "x", at = 2 } }\nvalue = [0, -2e4]\n'
    '[[probe]]\nname = "tip"\nat = [2, 0.5]\n'
)
TWO_BODIES = (
    moving("bdf2", more="adaptive = {}\n")
    + "[contact]\nenabled = false\n"
    + box("P1", cells="[4, 2, 2]")
    + '[[body]]\nname = "ball"\nelement = "P2"\nmesh = { box = { size = [0.5, 0.5, 0.5], cells = [2, 2, 2] } }\n'
    'material = { law = "stable_neo_hookean", youngs_modulus = 2e5, poissons_ratio = 0.4, density = 500 }\n'
    "translate = [0.7, 0.2, 1.5]\n"
    '[[fix]]\nname = "wall"\nbody = "bar"\nwhere = { plane = { axis = "x", at = 0 } }\n'
    '[[probe]]\nname = "corner"\nbody = "ball"\nat = [0.7, 0.2, 1.5]\n'
)
FIBRES = (
    STATIC + '[[body]]\nname = "bar"\nelement = "P2P0"\nmesh = { box = { size = [2, 1, 1], cells = [4, 2, 2] } }\n'
    'rotate = { axis = [0, 0, 1], degrees = 0 }\n[body.material]\nlaw = "holzapfel_gasser_ogden"\nshear_modulus = 3e5\n'
    "bulk_modulus = 9e6\nfibre_modulus = 2e5\nfibre_stiffening = 0.8\nfibres = [[0.8, 0.6, 0], [0.8, -0.6, 0]]\n"
)

SCENES = [
    SharedScene("P2 bent by a traction", STATIC + box("P2", cells="[4, 2, 2]") + CLAMP + BENT + TIP, (2, 3)),
    SharedScene("P1 with forces on nodes, springs and a body force", STATIC + box("P1") + CLAMP + HUNG + TIP, (3,)),
    SharedScene(
        "nearly incompressible P2P0 under a pressure that follows",
        STATIC + box("P2P0", "mooney_rivlin", 0.49, cells="[4, 2, 2]") + CLAMP + PRESSED + TIP,
        slack=10,
    ),
    SharedScene(
        "Q1 turned by its ends",
        STATIC + box("Q1", "yeoh", more=', kind = "hexahedra"') + CLAMP + TURN + TIP,
        ties=True,
    ),
    SharedScene("Q1 in the plane", FLAT, (2, 3)),
    SharedScene("linear elasticity", STATIC + box("P1", "linear_elastic") + CLAMP + BENT + TIP),
    SharedScene("fibres", FIBRES + CLAMP + BENT.replace("[0, 2e4, -3e4]", "[0, 3e3, -4e3]") + TIP, slack=10),
    SharedScene("falls on colliders", moving("backward_euler", 0.1) + box("P1") + GROUND + TIP, (3,), slack=100),
    SharedScene(
        "spins freely with damping",
        moving("midpoint")
        + box("P2", cells="[3, 2, 2]", body=FREE + "damping = { stiffness = 1e-3, mass = 0.5 }\n")
        + TIP,
        ties=True,
    ),
    SharedScene("swings by tr_bdf2", moving("tr_bdf2") + box("P1") + CLAMP + TIP),
    SharedScene(
        "swings by newmark with a consistent mass",
        moving("newmark") + box("P2", cells="[3, 2, 2]", body='mass = "consistent"\n') + CLAMP + TIP,
        slack=10,
    ),
    # The length of a step follows an estimate that solvers filter to 1e-3.
    SharedScene("two bodies in steps that adapt", TWO_BODIES, (3,), slack=1e6),
]
# Large enough for METIS to take a while.
ENDLESS = moving("backward_euler", 1e5) + CLAMP + box("P1", cells="[40, 20, 20]")
RESUMED = SharedScene("resumed", moving("bdf2") + box("P1") + CLAMP + TIP, slack=10)

SMALL = STATIC + box("P1", cells="[1, 1, 1]") + CLAMP + BENT
BLOCKS = TWO_BODIES.replace("[contact]\nenabled = false\n", "")
REFUSALS = {
    "more processes than cells": (SMALL, 7, ["6 cells", "start fewer"]),
    "bodies that meet": (BLOCKS, 2, ["contact", "run it on one process"]),
    "arc length": (
        (STATIC + box("P1") + CLAMP + BENT).replace(
            'kind = "static"\n', 'kind = "static"\nload_control = "arc_length"\n'
        ),
        2,
        ["arc_length", "run it on one process"],
    ),
    "another solver": (SMALL + '[solver]\nkind = "cg_amg"\n', 2, ["petsc_gamg", "cg_amg"]),
    "a ball that is small beside the facets": (
        moving("backward_euler")
        + box("P1")
        + GROUND.replace("center = [1, 0.5, 21.06]\nradius = 20", "center = [1, 0.5, 1.36]\nradius = 0.3"),
        2,
        ["sphere", "run it on one process"],
    ),
    "a viscoelastic material": (
        (STATIC + box("P1", "neo_hookean") + CLAMP + BENT).replace(
            'law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3',
            'law = "neo_hookean_isochoric", shear_modulus = 4e5, bulk_modulus = 1e6, '
            "viscoelastic = { g = [0.3], tau = [1] }",
        ),
        2,
        ["viscoelastic", "run it on one process"],
    ),
    "a scene that is wrong": (SMALL + "[nonsense]\n", 2, ["nonsense"]),
}
