"""A batch of 32 scenes over one mesh, value and gradient, beside one after another: seconds on the wall clock.

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


def seconds(work):
    start = time.perf_counter()
    return work(), time.perf_counter() - start


def compare(name, scene, size):
    values = {MODULUS: np.linspace(4e5, 9e5, size)}
    (batch, together), (alone, apart) = (
        seconds(lambda: resilin.value_and_gradient(scene, TIP, [MODULUS], values=values, batch=True)),
        seconds(
            lambda: [
                resilin.value_and_gradient(scene, TIP, [MODULUS], values={MODULUS: one}) for one in values[MODULUS]
            ]
        ),
    )
    same = np.array_equal(batch.gradients[MODULUS], [one.gradients[MODULUS] for one in alone])
    print(f"{name}: batch {together:.2f} s, one after another {apart:.2f} s, {apart / together:.2f}; same bits: {same}")


if __name__ == "__main__":
    print(f"{resilin.num_threads()} threads, 32 sets of numbers")
    motion = {"kind": "dynamic", "time_step": 0.01, "end_time": 0.5}
    for _ in range(3):
        compare("statics, 600 tetrahedra", beam([25, 2, 2]), 32)
        compare("statics, 4,800 tetrahedra", beam([50, 4, 4]), 32)
        compare("motion, 600 tetrahedra, 50 steps", beam([25, 2, 2], **motion), 32)
