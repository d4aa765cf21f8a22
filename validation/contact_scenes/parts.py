"""Building blocks of the contact scenes; lengths are in metres, y is up."""

GRAVITY = [0, -9.80665, 0]
OUTPUT = {"formats": ["vtu"]}


def material(law, youngs_modulus, density=1000, poissons_ratio=0.4):
    return {"law": law, "youngs_modulus": youngs_modulus, "poissons_ratio": poissons_ratio, "density": density}


def body(name, mesh, of, **more):
    return {"name": name, "element": "P1", "mesh": mesh, "material": of, **more}


def box(size, cells, origin):
    return {"box": {"size": size, "cells": cells, "origin": origin}}


def simulation(time_step, end_time, gravity=GRAVITY, **more):
    return {"kind": "dynamic", "gravity": gravity, "time_step": time_step, "end_time": end_time, **more}


def plane(name, point, normal, reach, friction=0.0):
    return {
        "name": name,
        "kind": "half_space",
        "point": point,
        "normal": normal,
        "activation_distance": reach,
        "friction": friction,
    }


def contact(reach, speed=None, **more):
    return {"activation_distance": reach, "friction_speed": speed or reach, **more}
