"""A stiff inclusion in the shape of a heart, found from markers on a pulled sheet: the modulus of every cell.

Each of 1,152 cells has a modulus of its own. 196 markers, seen under two pulls, are too few and too noisy for so many,
so neighbours are asked to be alike: 1/2 |r|^2 + weight/2 |D m|^2, m = log E, D the differences between neighbours. The
method is Gauss-Newton's in m; its matrix acts on vectors by `gauss_newton_product`, one forward and one transposed
product each. The weight is that of the corner of the L-curve.

    python examples/python/heart.py [heart.png]
"""

import sys

import numpy as np

import resilin

SOFT, STIFF = 1e5, 4e5  # [Pa]
SIGMA = 2e-4  # of the markers [m]
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
    """Of both pulls, from a finer sheet with the heart in it, with noise."""
    fine = square(40)
    moduli = np.where(is_heart(centres(fine)), STIFF, SOFT)
    noise = np.random.default_rng(1)
    objective = {"position": {"at": AT, "target": np.zeros_like(AT)}}
    runs = [resilin.value_and_gradient(pulled(fine, moduli, axis), objective, [E]) for axis in "xy"]
    return [run.residuals.reshape(AT.shape) + SIGMA * noise.standard_normal(AT.shape) for run in runs]


def differences(cells):
    """Pairs of cells that share an edge."""
    edges = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(cells)), 3)
    order = np.lexsort(edges.T)
    is_same = np.all(edges[order][1:] == edges[order][:-1], axis=1)
    return owner[order][:-1][is_same], owner[order][1:][is_same]


def conjugate_gradients(product, b, tolerance=1e-2, most=80):
    x, r = np.zeros_like(b), b.copy()
    p, squared = r.copy(), r @ r
    for _ in range(most):
        if squared <= (tolerance**2) * (b @ b):
            break
        q = product(p)
        step = squared / (p @ q)
        x, r = x + step * p, r - step * q
        p, squared = r + (r @ r) / squared * p, r @ r
    return x


class Search:
    def __init__(self, cells=24):
        self.mesh = square(cells)
        self.first, self.second = differences(self.mesh.cells)
        self.targets = markers()
        self.solves = 0

    def roughness(self, m):
        """D^T D m"""
        jump = m[self.first] - m[self.second]
        result = np.zeros_like(m)
        np.add.at(result, self.first, jump)
        np.add.at(result, self.second, -jump)
        return result

    def runs(self, m):
        self.solves += 2
        return [
            resilin.value_and_gradient(
                pulled(self.mesh, np.exp(m), axis), {"position": {"at": AT, "target": target, "sigma": SIGMA}}, [E]
            )
            for axis, target in zip("xy", self.targets, strict=True)
        ]

    def step(self, m, runs, weight):
        """One of Gauss-Newton."""
        moduli = np.exp(m)

        def product(v):
            products = [run.gauss_newton_product({E: moduli * v})[E] for run in runs]
            return weight * self.roughness(v) + moduli * sum(products)

        slope = weight * self.roughness(m) + moduli * sum(run.gradients[E] for run in runs)
        return m - conjugate_gradients(product, slope)

    def found(self, weight, m, runs, steps):
        for _ in range(steps):
            m = self.step(m, runs, weight)
            runs = self.runs(m)
        misfit = 2 * sum(run.value for run in runs)
        return m, runs, misfit, m @ self.roughness(m)


def corner(misfits, roughnesses):
    """Of the L-curve: where it is bent most for its length, in logarithms."""
    way = np.diff(np.log([misfits, roughnesses]), axis=1)
    turn = np.abs(np.diff(np.arctan2(way[1], way[0])))
    length = np.linalg.norm(way, axis=0)
    return 1 + int(np.argmax(turn / (length[1:] + length[:-1])))


search = Search()
m = np.full(len(search.mesh.cells), np.log(2 * SOFT))
runs = search.runs(m)
weights = 10.0 ** np.arange(3, -1, -0.5)
curve = []
for i, weight in enumerate(weights):
    m, runs, misfit, rough = search.found(weight, m, runs, 4 if i == 0 else 2)
    curve.append((m, misfit, rough))
    print(f"weight {weight:g}: misfit {misfit:.6g} of {4 * len(AT)} numbers, roughness {rough:.4g}")
chosen = corner([misfit for _, misfit, _ in curve], [rough for _, _, rough in curve])
moduli = np.exp(curve[chosen][0])
truth = np.where(is_heart(centres(search.mesh)), STIFF, SOFT)
print(f"weight {weights[chosen]:g}, {search.solves} equilibria of the sheet")


def draw(path):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    x, y = search.mesh.positions.T
    for ax, values, title in ((axes[0], truth, "the sheet"), (axes[1], moduli, "found from markers")):
        colours = ax.tripcolor(x, y, search.mesh.cells, facecolors=values / 1e3, vmin=50, vmax=450, cmap="magma")
        ax.set(aspect="equal", title=title, xticks=[], yticks=[])
    axes[0].plot(*AT.T, ".", color="white", markersize=2)
    figure.colorbar(colours, ax=axes[1], label="Young's modulus [kPa]")
    axes[2].loglog([one[1] for one in curve], [one[2] for one in curve], "o-", color="black")
    axes[2].loglog(*curve[chosen][1:], "o", color="crimson", markersize=10)
    axes[2].set(xlabel="misfit |r|²", ylabel="roughness |D m|²", title="L-curve")
    figure.savefig(path, dpi=110)
    return figure


if __name__ == "__main__" and len(sys.argv) > 1:
    draw(sys.argv[1])
