"""The pressure that bends a soft finger until its tip meets a target: Newton's method on one exact derivative.

python examples/python/finger.py [finger.png]
"""

import sys

import resilin


def finger(pressure):
    """A strip, held at one end, under a pressure on its upper side [Pa]."""
    return {
        "simulation": {"kind": "static", "dimension": 2},
        "body": [
            {
                "name": "finger",
                "mesh": {"box": {"size": [0.1, 0.01], "cells": [20, 2]}},
                "material": {"law": "stable_neo_hookean", "youngs_modulus": 2e5, "poissons_ratio": 0.45},
            }
        ],
        "fix": [{"name": "hand", "where": {"plane": {"axis": "x", "at": 0}}}],
        "load": [{"name": "air", "kind": "pressure", "value": pressure, "where": {"plane": {"axis": "y", "at": 0.01}}}],
        "probe": [{"name": "tip", "at": [0.1, 0.01]}],
        "newton": {"tolerance": 1e-11},
    }


TARGET = -0.03  # target of the tip's displacement upwards [m]
pressure = 50.0
for forward_solves in range(1, 20):
    height, slopes = resilin.value_and_gradient(
        finger(pressure), {"probe": {"name": "tip", "component": "y"}}, ["load.air.value"]
    )
    print(f"{forward_solves}: {pressure:.6g} Pa, tip {1e3 * height:.6g} mm")
    if abs(height - TARGET) < 1e-9:
        break
    pressure += (TARGET - height) / slopes["load.air.value"]

if __name__ == "__main__" and len(sys.argv) > 1:
    resilin.run(finger(pressure)).plot("displacement.y", rest=True, size=(900, 450)).save(sys.argv[1])
