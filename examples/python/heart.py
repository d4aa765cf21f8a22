"""A stiff inclusion in the shape of a heart, found from markers on a pulled sheet: the modulus of every cell.

Each of 1,152 cells has a modulus of its own. 196 markers, seen under two pulls, are too few and too noisy for so many,
so neighbours are asked to be alike, as much as the corner of the L-curve says.

    python examples/python/heart.py [heart.png]
"""

import sys

import numpy as np

import resilin

SOFT, STIFF = 1e5, 4e5  # [Pa]
SIGMA = 2e-4  # sigma of the markers [m]
E = "body.sheet.material.youngs_modulus"
AT = np.stack(np.meshgrid(np.linspace(0.035, 0.965, 14), np.linspace(0.035, 0.965, 14)), axis=-1).reshape(-1, 2)


def square(cells):
    return resilin.Mesh.rectangle(size=(1, 1), cells=(cells, cells), pattern="alternating")


def centres(mesh):
    return mesh.positions[mesh.cells].mean(axis=1)


def is_heart(points):
    x, y = (points[:, 0] - 0.5) / 0.26, (points[:, 1] - 0.48) / 0.26
    return (x**2 + y**2 - 1) ** 3 - x**2 * y**3 < 0


def pulled(mesh, moduli, axis):
    """The sheet held at one side and pulled at the other, along x or y."""
    return {
        "simulation": {"kind": "static", "dimension": 2},
        "body": [
            {
                "name": "sheet",
                "mesh": mesh,
                "element": "P1",
                "material": {"law": "neo_hookean", "youngs_modulus": moduli, "poissons_ratio": 0.3},
            }
        ],
        "fix": [{"name": "grip", "where": {"plane": {"axis": axis, "at": 0}}}],
        "load": [
            {
                "name": "pull",
                "kind": "traction",
                "value": [1e4, 0] if axis == "x" else [0, 1e4],
                "where": {"plane": {"axis": axis, "at": 1}},
            }
        ],
        "newton": {"tolerance": 1e-9},
    }


def markers():
    """Markers of both pulls, from a finer sheet with the heart in it, with noise."""
    fine = square(40)
    moduli = np.where(is_heart(centres(fine)), STIFF, SOFT)
    noise = np.random.default_rng(1)
    objective = {"displacement": {"at": AT, "target": np.zeros_like(AT)}}
    runs = [resilin.value_and_gradient(pulled(fine, moduli, axis), objective, [E]) for axis in "xy"]
    return [run.residuals.reshape(AT.shape) + SIGMA * noise.standard_normal(AT.shape) for run in runs]


mesh = square(24)
fit = resilin.fit_scenes(
    {
        "experiment": [
            {
                "name": axis,
                "scene": pulled(mesh, 2 * SOFT, axis),
                "markers": {"at": AT, "displacement": seen, "sigma": SIGMA},
            }
            for axis, seen in zip("xy", markers(), strict=True)
        ],
        "parameter": [{"key": E, "per": "cell"}],
    },
    on_solve=print,
)
print(fit.text)
moduli = fit.fields[E].values
truth = np.where(is_heart(centres(mesh)), STIFF, SOFT)


def draw(path):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    x, y = mesh.positions.T
    for ax, values, title in ((axes[0], truth, "the sheet"), (axes[1], moduli, "found from markers")):
        colours = ax.tripcolor(x, y, mesh.cells, facecolors=values / 1e3, vmin=50, vmax=450, cmap="magma")
        ax.set(aspect="equal", title=title, xticks=[], yticks=[])
    axes[0].plot(*AT.T, ".", color="white", markersize=2)
    figure.colorbar(colours, ax=axes[1], label="Young's modulus [kPa]")
    strengths, misfits, roughnesses = fit.regularisation.l_curve.T
    axes[2].loglog(misfits, roughnesses, color="black")
    chosen = np.abs(np.log(strengths / fit.regularisation.strength)).argmin()
    axes[2].loglog(misfits[chosen], roughnesses[chosen], "o", color="crimson", markersize=10)
    axes[2].set(xlabel="misfit |r|²", ylabel="roughness L² |∇ log E|²", title="L-curve")
    figure.savefig(path, dpi=110)
    return figure


if __name__ == "__main__" and len(sys.argv) > 1:
    draw(sys.argv[1])
