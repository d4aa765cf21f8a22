"""Scenes that are differentiated."""

E = "body.bar.material.youngs_modulus"


def bar(kind="static", modulus=1e5, **simulation):
    return {
        "simulation": {"kind": kind, "gravity": [0, 0, -9.81], **simulation},
        "body": [
            {
                "name": "bar",
                "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [4, 1, 1]}},
                "element": "P1",
                "material": {"law": "neo_hookean", "youngs_modulus": modulus, "poissons_ratio": 0.3, "density": 1000},
            }
        ],
        "fix": [{"name": "wall", "where": {"plane": {"axis": "x", "at": 0}}}],
        "load": [{"name": "pull", "kind": "body_force", "value": [10, 0, 0]}],
        "section": [{"name": "middle", "plane": {"axis": "x", "at": 0.5}}],
        "probe": [{"name": "tip", "at": [1, 0.25, 0.25]}],
        "newton": {"tolerance": 1e-12},
    }


def motion(modulus=1e5, **simulation):
    return bar("dynamic", modulus, **{"time_step": 0.01, "end_time": 0.05, **simulation})
