"""The rest shape of a beam that is straight under its own weight, as drawn: inverse design.

python examples/python/straight_beam.py [straight_beam.png]
"""

import sys

import numpy as np

import resilin

drawn = resilin.Mesh.box(size=(0.8, 0.2, 0.1), cells=(16, 2, 2))


def beam(mesh):
    """Silicone, held at one end."""
    return {
        "simulation": {"kind": "static", "gravity": [0, 0, -9.81]},
        "body": [
            {
                "name": "beam",
                "mesh": mesh,
                "element": "P2",
                "material": {"law": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.4, "density": 1000},
            }
        ],
        "fix": [{"name": "wall", "where": {"group": "x_min"}}],
    }


found = resilin.find_rest_shape(beam(drawn))
rest = resilin.Mesh(found.positions["beam"], drawn.cells, drawn.groups)
rise = np.ptp(rest.positions[:, 2]) - 0.1
result = resilin.run(beam(rest))
off = np.linalg.norm(result.positions[-1][: len(drawn.positions)] - drawn.positions, axis=1).max()
print(f"its tip rises by {rise:.4g} m; under its weight it is straight to {off:.2g} m")

if __name__ == "__main__" and len(sys.argv) > 1:
    result.plot("displacement.z", rest=True, size=(900, 500)).save(sys.argv[1])
