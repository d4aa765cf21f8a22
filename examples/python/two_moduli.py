"""Two moduli of a beam from eleven markers: Gauss-Newton in their logarithms, with exact derivatives."""

import numpy as np

import resilin

AT = [[x, 0.1, 0.1] for x in np.linspace(0.05, 1, 11)]
mesh = resilin.Mesh.box(size=(1, 0.2, 0.2), cells=(10, 2, 2))
is_root = mesh.positions[mesh.cells].mean(axis=1)[:, 0] < 0.5


def beam(moduli):
    """A beam under its weight whose halves have these moduli [Pa]."""
    material = {"law": "neo_hookean", "youngs_modulus": np.where(is_root, *moduli), "poissons_ratio": 0.3}
    return {
        "simulation": {"kind": "static", "gravity": [0, 0, -9.81]},
        "body": [{"name": "beam", "mesh": mesh, "element": "P1", "material": material}],
        "fix": [{"name": "wall", "where": {"plane": {"axis": "x", "at": 0}}}],
        "newton": {"tolerance": 1e-11},
    }


E = "body.beam.material.youngs_modulus"


def measured(moduli, target):
    """Residuals of the markers, and their slopes by the logarithms of both moduli."""
    run = resilin.value_and_gradient(beam(moduli), {"position": {"at": AT, "target": target, "sigma": 1e-3}}, [E])
    slopes = [
        run.jvp({E: np.where(half, modulus, 0)})["residuals"]
        for half, modulus in zip((is_root, ~is_root), moduli, strict=True)
    ]
    return run.residuals, np.transpose(slopes)


truth = np.array([8e5, 3e5])
target = measured(truth, np.zeros((11, 3)))[0].reshape(11, 3) * 1e-3
moduli = np.array([5e5, 5e5])
for forward_solves in range(1, 20):
    residuals, slopes = measured(moduli, target)
    step = -np.linalg.lstsq(slopes, residuals, rcond=None)[0]
    moduli = moduli * np.exp(step)
    print(f"{forward_solves}: root {moduli[0]:.6g} Pa, tip {moduli[1]:.6g} Pa")
    if np.abs(step).max() < 1e-6:
        break
