"""Makes pair_reference.json: distances, their derivatives and times of collision by ipctk 1.6.1 (MIT licence).

    pip install ipctk numpy
    python tests/data/make_pair_reference.py

Of each kind of pair: well-shaped ones with gradient g and H v of the squared distance, v = (1, -2, 3, -4, ...) / 10,
degenerate ones with the distance alone, and moving ones with the time of the first touch by tight inclusion, null
without one.
"""

import json
import pathlib

import ipctk
import numpy as np

FUNCTIONS = {
    "point_point": ("point_point_distance", 2),
    "point_edge": ("point_edge_distance", 3),
    "point_triangle": ("point_triangle_distance", 4),
    "edge_edge": ("edge_edge_distance", 4),
}
PLAIN, DEGENERATE, MOVING = 12, 30, 20


def degenerate(random, count):
    x = random.integers(-2, 3, (count, 3)).astype(float)
    if count == 4 and min(np.abs(x[1] - x[0]).max(), np.abs(x[3] - x[2]).max()) == 0:
        return degenerate(random, count)  # theirs take edges of no length for lines
    family = random.integers(0, 4)
    if family == 0 and count < 4:
        x[-1] = x[-2] + 1e-9 * random.standard_normal(3)
    elif family == 1 and count > 2:
        x[-1] = x[-2] + 0.5 * (x[1] - x[0])
    elif family == 2:
        x = random.standard_normal((count, 3))
        x[0] = 0.25 * x[-1] + 0.75 * x[-2] + 1e-6 * random.standard_normal(3)
    return x * 10.0 ** random.integers(-6, 7)


def rounded(values):
    return [float(f"{value:.17g}") for value in np.ravel(values)]


def touch(kind, x, y):
    """The time of the first touch, or None."""
    ccd = ipctk.TightInclusionCCD(tolerance=1e-8, max_iterations=10_000_000, conservative_rescaling=1.0)
    hit, time = getattr(ccd, f"{kind}_ccd")(*x, *y)
    return float(time) if hit else None


def pairs_of(kind, random):
    name, count = FUNCTIONS[kind]
    value, gradient, hessian = (getattr(ipctk, name + end) for end in ("", "_gradient", "_hessian"))
    direction = np.array([(i + 1) * (-1) ** i for i in range(3 * count)]) / 10
    for _ in range(PLAIN):
        x = random.uniform(-1, 1, (count, 3))
        yield {
            "x": rounded(x),
            "squared_distance": float(value(*x)),
            "gradient": rounded(gradient(*x)),
            "hessian_times_v": rounded(hessian(*x) @ direction),
        }
    for _ in range(DEGENERATE):
        x = degenerate(random, count)
        yield {"x": rounded(x), "squared_distance": float(value(*x))}
    for _ in range(MOVING):
        x, p = random.uniform(-1, 1, (count, 3)), random.uniform(-3, 3, (count, 3))
        if random.uniform() < 0.8:  # points miss all else: aim at a point of the last two vertices
            time, share = random.uniform(0.2, 0.8), random.uniform(0, 1 if count > 2 else 0)
            end = x + time * p
            p[0] = (share * end[-2] + (1 - share) * end[-1] - x[0]) / time
        yield {"x": rounded(x), "p": rounded(p), "touch": touch(kind, x, x + p)}


def main():
    random = np.random.default_rng(14)
    pairs = {kind: list(pairs_of(kind, random)) for kind in FUNCTIONS}
    file = pathlib.Path(__file__).with_name("pair_reference.json")
    lines = ",\n".join(
        f'"{kind}": [\n' + ",\n".join(json.dumps(pair) for pair in of_kind) + "\n]" for kind, of_kind in pairs.items()
    )
    file.write_text("{\n" + lines + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
