"""A batch of 32 scenes over one mesh, value and gradient, beside one after another: seconds on the clock, and of cores.

python benchmarks/python/batches.py
"""

import time

import numpy as np

import resilin

MODULUS = "body.beam.material.youngs_modulus"
TIP = {"position": {"at": [1, 0.1, 0.1], "target": [0.9, 0.1, -0.3], "sigma": 1e-3}}


def beam(cells, **simulation):
    return {
        "simulation": {"kind": "static", "gravity": [0, 0, -9.81], **simulation},
        "body": [
            {
                "name": "beam",
                "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": cells}},
                "element": "P1",
                "material": {"law": "neo_hookean", "youngs_modulus": 5e5, "poissons_ratio": 0.3, "density": 1000},
            }
        ],
        "fix": [{"name": "wall", "where": {"plane": {"axis": "x", "at": 0}}}],
    }


def timed(work):
    """Returns the result, and the seconds on the wall clock and of processors."""
    wall, processors = time.perf_counter(), time.process_time()
    return work(), time.perf_counter() - wall, time.process_time() - processors


def compare(name, scene, size):
    moduli = np.linspace(4e5, 9e5, size)
    batch, wall, processors = timed(
        lambda: resilin.value_and_gradient(scene, TIP, [MODULUS], values={MODULUS: moduli}, batch=True)
    )
    alone, wall_alone, processors_alone = timed(
        lambda: [resilin.value_and_gradient(scene, TIP, [MODULUS], values={MODULUS: one}) for one in moduli]
    )
    same = np.array_equal(batch.gradients[MODULUS], [one.gradients[MODULUS] for one in alone])
    print(
        f"{name}: batch {wall:.2f} s ({processors:.2f} s of processors), one after another {wall_alone:.2f} s "
        f"({processors_alone:.2f} s), {wall_alone / wall:.2f} times as fast; same bits: {same}",
        flush=True,
    )


if __name__ == "__main__":
    print(f"{resilin.num_threads()} threads, 32 sets of numbers")
    motion = {"kind": "dynamic", "time_step": 0.01, "end_time": 0.5}
    for _ in range(3):
        compare("statics, 600 tetrahedra", beam([25, 2, 2]), 32)
        compare("statics, 4,800 tetrahedra", beam([50, 4, 4]), 32)
        compare("motion, 600 tetrahedra, 50 steps", beam([25, 2, 2], **motion), 32)
