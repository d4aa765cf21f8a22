"""How stiff a rubber sheet with holes is, over 200 geometries and materials: one picture, and one file to learn from.

python perforated_sheet.py [FOLDER] [NUMBER OF SCENES]

leaves FOLDER/stiffness.png and FOLDER/perforated_sheet.h5: parameters (200, 4) and displacements (200, N, 2) of all
nodes. Run again it simulates nothing that is there already. Needs matplotlib and h5py.
"""

import pathlib
import sys

import h5py
import matplotlib.pyplot as plt
import numpy as np

import resilin

HOLES = 3  # along each side
SECTORS = 4  # quadrilaterals along a quarter of a hole
LAYERS = 3  # between a hole and the sides of its square
STRETCH = 0.15
RANGES = {"radius": (0.05, 0.4), "flatness": (0.6, 1.0), "youngs_modulus": (2e5, 2e6), "poissons_ratio": (0.2, 0.45)}


def square_with_hole(radius, flatness):
    """Positions (4 SECTORS, LAYERS + 1, 2) between an ellipse and the square of side 1 around it."""
    t = np.arange(SECTORS) / SECTORS
    side = np.stack([np.full(SECTORS, 0.5), t - 0.5], axis=1)  # points of the right side, then turned by quarters
    turn = np.array([[0, 1], [-1, 0]])
    outer = np.concatenate([side @ np.linalg.matrix_power(turn, k) for k in range(4)])
    angle = np.arctan2(outer[:, 1], outer[:, 0])
    inner = radius * np.stack([np.cos(angle), flatness * np.sin(angle)], axis=1)
    share = (np.arange(LAYERS + 1) / LAYERS) ** 1.5  # finer near the hole
    return inner[:, None] + share[None, :, None] * (outer - inner)[:, None]


def perforated_sheet(radius, flatness):
    """A sheet of HOLES x HOLES squares with a hole each, in quadrilaterals; all have the same cells."""
    square = square_with_hole(radius, flatness)
    around, across = np.meshgrid(np.arange(4 * SECTORS), np.arange(LAYERS), indexing="ij")
    number = np.arange(4 * SECTORS * (LAYERS + 1)).reshape(4 * SECTORS, LAYERS + 1)
    after = (around + 1) % (4 * SECTORS)
    cells = np.stack(
        [number[around, across], number[around, across + 1], number[after, across + 1], number[after, across]], axis=-1
    ).reshape(-1, 4)
    places = np.array([[i, j] for i in range(HOLES) for j in range(HOLES)])
    points = (places[:, None] + square.reshape(1, -1, 2)).reshape(-1, 2)
    cells = (np.arange(len(places))[:, None, None] * number.size + cells).reshape(-1, 4)
    _, first, joined = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    # In the order of the points, which does not depend on the holes.
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return resilin.Mesh((points[first[order]] + 0.5) / HOLES, rank[joined.reshape(-1)][cells])


def draw_parameters(count):
    """(count, 4), evenly between the ends of RANGES."""
    low, high = np.array(list(RANGES.values())).T
    samples = np.random.default_rng(1).permuted(np.tile(np.arange(count), (len(low), 1)), axis=1).T
    return low + (high - low) * (samples + 0.5) / count


def simulate(folder, count):
    """The table of the sweep, with the results of all scenes."""
    parameters = draw_parameters(count)
    scene = {
        "simulation": {"dimension": 2, "load_steps": 3},
        "body": [{"name": "sheet", "material": {"law": "neo_hookean"}}],
        "fix": [
            {"name": "left", "where": {"plane": {"axis": "x", "at": 0}}, "components": "x"},
            {
                "name": "right",
                "where": {"plane": {"axis": "x", "at": 1}},
                "components": "x",
                "displacement": [STRETCH, 0],
            },
            {"name": "floor", "where": {"plane": {"axis": "y", "at": 0}}, "components": "y"},
        ],
        "output": {"formats": ["vtu"]},
    }
    varied = {
        "body.sheet.mesh": [perforated_sheet(*row[:2]) for row in parameters],
        "body.sheet.material.youngs_modulus": parameters[:, 2],
        "body.sheet.material.poissons_ratio": parameters[:, 3],
    }
    quantities = [
        {"name": "load", "of": "load", "over": "all"},
        {"name": "pull", "of": "reaction.right.x", "over": "all"},
        "max.von_mises",
    ]
    table = resilin.sweep(
        scene, varied, method="list", quantities=quantities, keep="all", out=folder / "sweep", progress=True
    )
    return parameters, table


def stiffness(table, step):
    """Pull over stretch at a load step, in parts of the solid sheet's stiffness, E / (1 - nu^2) in plane strain."""
    pull = np.array([forces[step] for forces in table["pull"]])
    stretch = np.array([STRETCH * loads[step] for loads in table["load"]])
    solid = table["body.sheet.material.youngs_modulus"] / (1 - table["body.sheet.material.poissons_ratio"] ** 2)
    return pull / stretch / solid


def write_data(path, parameters, table):
    """One file of HDF5: parameters, and the displacements that they lead to."""
    with h5py.File(path, "w") as file:
        file["parameters"] = parameters[table["scene"]]
        file["parameters"].attrs["names"] = list(RANGES)
        shape = (table.num_rows, *table.field(0, "displacement").shape)
        displacements = file.create_dataset("displacements", shape, "f8", compression="gzip", chunks=(1, *shape[1:]))
        positions = file.create_dataset("rest_positions", shape, "f8", compression="gzip", chunks=(1, *shape[1:]))
        for row, scene in enumerate(table["scene"]):
            displacements[row] = table.field(scene, "displacement")
            positions[row] = table.rest_positions(scene)


def draw(path, parameters, table):
    """Stiffness over the area fraction of the holes."""
    fraction = np.pi * parameters[:, 0] ** 2 * parameters[:, 1]
    figure, ax = plt.subplots(figsize=(7, 4.5), layout="constrained")
    flatness = parameters[:, 1]
    points = ax.scatter(fraction, stiffness(table, 1), c=flatness, s=18, label=f"{100 * STRETCH / 3:.0f} % stretch")
    ax.scatter(fraction, stiffness(table, -1), c=flatness, s=18, marker="x", label=f"{100 * STRETCH:.0f} % stretch")
    few = np.linspace(0, 0.12)
    ax.plot(few, 1 / (1 + 3 * few), "k--", lw=1, label="few round holes: 1 / (1 + 3 fraction)")
    ax.set(xlabel="area fraction of the holes", ylabel="stiffness / stiffness of a solid sheet", ylim=(0, 1.05))
    ax.legend()
    figure.colorbar(points, label="height of the holes / width")
    figure.savefig(path, dpi=120)
    plt.close(figure)


def main(folder, count):
    folder.mkdir(parents=True, exist_ok=True)
    parameters, table = simulate(folder, count)
    print(table)
    draw(folder / "stiffness.png", parameters, table)
    write_data(folder / "perforated_sheet.h5", parameters, table)
    print(f"{folder / 'stiffness.png'}, {folder / 'perforated_sheet.h5'}")
    return parameters, table


if __name__ == "__main__":
    where = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/perforated_sheet")
    main(where, int(sys.argv[2]) if len(sys.argv) > 2 else 200)
