"""A throw: the velocity and the spin with which a soft bar leaves the hand so that both its ends meet their targets.

The bar bends and wobbles in flight. Its velocities at the start are a parameter, (V, 2), of which a throw has three
numbers: Gauss-Newton on four distances, with exact derivatives through all time steps.

    python examples/python/throw.py [throw.png]
"""

import sys

import numpy as np

import resilin

mesh = resilin.Mesh.rectangle(size=(0.5, 0.06), cells=(20, 2))
ENDS = np.array([[0, 0.03], [0.5, 0.03]])
TARGETS = np.array([[2.2, 0.8], [2.2, 0.3]])  # upright, half a second later [m]
VELOCITIES = "body.bar.initial_velocities"
arm = mesh.positions - [0.25, 0.03]
# Velocity of each vertex for a metre per second along x, along y and a turn of one radian per second.
MOTIONS = np.array([np.tile([1.0, 0.0], (len(arm), 1)), np.tile([0.0, 1.0], (len(arm), 1)), arm[:, ::-1] * [-1, 1]])


def thrown(throw):
    return {
        "simulation": {
            "kind": "dynamic",
            "dimension": 2,
            "gravity": [0, -9.81],
            "time_step": 0.005,
            "end_time": 0.5,
            "integrator": "newmark",
        },
        "body": [
            {
                "name": "bar",
                "mesh": mesh,
                "element": "P1",
                "material": {
                    "law": "stable_neo_hookean",
                    "youngs_modulus": 2e5,
                    "poissons_ratio": 0.3,
                    "density": 1000,
                },
                "initial_velocities": np.tensordot(throw, MOTIONS, axes=1),
            }
        ],
        "contact": {"enabled": False},
        "newton": {"tolerance": 1e-10},
    }


objective = {"position": {"at": ENDS, "target": TARGETS, "sigma": 1e-3}}
throw = np.array([3.0, 3.0, 0.0])  # m/s, m/s, rad/s
for forward_solves in range(1, 20):
    run = resilin.value_and_gradient(thrown(throw), objective, [VELOCITIES])
    distances = 1e-3 * run.residuals.reshape(2, 2)
    print(
        f"{forward_solves}: {throw[0]:.5g} m/s, {throw[1]:.5g} m/s, {throw[2]:.5g} rad/s, "
        f"ends {np.linalg.norm(distances, axis=1) * 1e3} mm beside their targets"
    )
    slopes = np.transpose([run.jvp({VELOCITIES: motion})["residuals"] for motion in MOTIONS])
    step = -np.linalg.lstsq(slopes, run.residuals, rcond=None)[0]
    if np.abs(step).max() < 1e-7:
        break
    throw = throw + step


def draw(path):
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
    frames = run.positions
    for frame in range(0, len(frames), 10):
        colour = plt.get_cmap("viridis")(frame / len(frames))
        ax.triplot(*frames[frame].T, mesh.cells, color=colour, linewidth=0.4)
    ax.plot(*TARGETS.T, "+", color="crimson", markersize=14)
    ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    figure.savefig(path, dpi=110)
    return figure


if __name__ == "__main__" and len(sys.argv) > 1:
    draw(sys.argv[1])
