"""Fields of moduli of 240 to 10,000 cells found from markers: solves, seconds, and how far they are off.

    python benchmarks/python/fit_fields.py [CELLS ...]

A sheet with a hill and a hollow of a factor of 2 in its modulus, under two pulls; markers of a finer sheet with noise.
"""

import sys
import time

import numpy as np

import resilin

E = "body.sheet.material.youngs_modulus"
SIGMA = 2e-4  # sigma of the markers [m]
AT = np.stack(np.meshgrid(np.linspace(0.035, 0.965, 14), np.linspace(0.035, 0.965, 14)), axis=-1).reshape(-1, 2)


def square(cells):
    return resilin.Mesh.rectangle(size=(1, 1), cells=(cells, cells), pattern="alternating")


def modulus(mesh):
    x, y = mesh.positions[mesh.cells].mean(axis=1).T
    hill = np.exp(-((x - 0.3) ** 2 + (y - 0.6) ** 2) / 0.03)
    hollow = np.exp(-((x - 0.7) ** 2 + (y - 0.35) ** 2) / 0.03)
    return 1e5 * 2 ** (hill - hollow)


def pulled(mesh, moduli, axis):
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
    }


def markers():
    fine = square(90)
    objective = {"displacement": {"at": AT, "target": np.zeros_like(AT)}}
    runs = [resilin.value_and_gradient(pulled(fine, modulus(fine), axis), objective, [E]) for axis in "xy"]
    noise = np.random.default_rng(1)
    return [run.residuals.reshape(AT.shape) + SIGMA * noise.standard_normal(AT.shape) for run in runs]


seen = markers()
print("cells  numbers  solves  seconds  weight  combinations  misfit/freedom  off by (log)  within 95 %")
for wanted in [int(cells) for cells in sys.argv[1:]] or [242, 1152, 5000, 9800]:
    mesh = square(round(np.sqrt(wanted / 2)))
    begin = time.perf_counter()
    fit = resilin.fit_scenes(
        {
            "experiment": [
                {
                    "name": axis,
                    "scene": pulled(mesh, 1.5e5, axis),
                    "markers": {"at": AT, "displacement": of_axis, "sigma": SIGMA},
                }
                for axis, of_axis in zip("xy", seen, strict=True)
            ],
            "parameter": [{"key": E, "per": "cell"}],
        }
    )
    seconds = time.perf_counter() - begin
    field, truth = fit.fields[E], modulus(mesh)
    low, high = field.interval
    off = np.sqrt(np.mean(np.log(field.values / truth) ** 2))
    print(
        f"{len(mesh.cells):5d}  {4 * len(AT):7d}  {fit.solves:6d}  {seconds:7.1f}  {fit.regularisation.strength:6.3g}"
        f"  {fit.regularisation.freedom:12.0f}  {fit.sum_of_squares / fit.degrees_of_freedom:14.2f}  {off:12.3f}"
        f"  {np.mean((low <= truth) & (truth <= high)):11.1%}" + ("" if fit.is_converged else "  not converged"),
        flush=True,
    )
