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


def halved(modulus=1e5, load_steps=2, max_iterations=7, **more):
    """A bar bent so far that load steps which are given few iterations have to be halved."""
    scene = bar(modulus=modulus, load_steps=load_steps)
    scene["load"][0]["value"] = [0, 0, -2e4]
    scene["newton"] = {"tolerance": 1e-10, "max_iterations": max_iterations}
    return scene | more


FLOOR = {
    "name": "floor",
    "kind": "half_space",
    "point": [0, 0, -0.2],
    "normal": [0, 0, 1],
    "friction": 0.3,
    "activation_distance": 0.01,
}
