"""Scenes that several tests simulate."""

import resilin


def cantilever(**simulation):
    """The beam of README.md, coarser: it hangs on a wall under its own weight."""
    return {
        "simulation": {"kind": "static", "gravity": [0, 0, -9.81], **simulation},
        "body": [
            {
                "name": "beam",
                "element": "P1",
                "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": [10, 2, 2]}},
                "material": {"law": "neo_hookean", "youngs_modulus": 5e5, "poissons_ratio": 0.3},
            }
        ],
        "fix": [{"name": "wall", "where": {"group": "x_min"}}],
        "probe": [{"name": "tip", "at": [1, 0.1, 0.1]}],
    }


def square(**simulation):
    """A square, stretched by 1.4 along x and let go."""
    mesh = resilin.Mesh.rectangle((1, 1), (4, 4), pattern="alternating")
    return {
        "simulation": {"kind": "dynamic", "dimension": 2, "time_step": 0.01, "end_time": 0.2, **simulation},
        "body": [
            {
                "name": "square",
                "element": "P1",
                "mesh": mesh,
                "material": {"law": "neo_hookean", "youngs_modulus": 1e5, "poissons_ratio": 0.4, "density": 1000},
                "initial_positions": mesh.positions * [1.4, 1],
            }
        ],
    }
