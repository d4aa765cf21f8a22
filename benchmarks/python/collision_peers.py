"""Candidates, times of collision and barriers of two surfaces: `resilin bench collision` beside ipctk.

    pip install ipctk numpy
    python benchmarks/python/collision_peers.py RESILIN [--n 41]

RESILIN is the program, whose benchmark is run with one thread. ipctk sees the same shapes: two cubes face to face or
two balls, 12 n^2 triangles each, 0.3 of the activation distance apart, its LBVH, its additive detection and its
barrier, one thread. Times are medians of calls on the wall clock.
"""

import argparse
import json
import statistics
import subprocess
import time

import ipctk
import numpy as np

REPETITIONS = 7


def cube_surface(n):
    """Vertices and triangles of the surface of the unit cube."""
    numbers, triangles = {}, []

    def vertex(axis, side, i, j):
        place = [0, 0, 0]
        place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = side * n, i, j
        return numbers.setdefault(tuple(place), len(numbers))

    for axis in range(3):
        for side in (0, 1):
            for i in range(n):
                for j in range(n):
                    a, b, c, d = (vertex(axis, side, i + di, j + dj) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
                    triangles += [[a, b, c], [a, c, d]]
    return np.array(list(numbers)) / n, np.array(triangles)


def ball_surface(n):
    vertices, triangles = cube_surface(n)
    directions = np.tan(np.pi / 4 * (2 * vertices - 1))
    return 0.5 + 0.5 * directions / np.linalg.norm(directions, axis=1, keepdims=True), triangles


def median_ms(action):
    times = []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        action()
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times)


def measure(surface, way):
    vertices, triangles = surface
    activation = 1e-3 * np.sqrt(6)
    count = len(vertices)
    rest = np.vstack([vertices, vertices + [0, 0, 1 + 0.3 * activation]])
    end = rest.copy()
    end[count:] += activation * np.array(way)
    faces = np.vstack([triangles, triangles + count])
    mesh = ipctk.CollisionMesh(rest, ipctk.edges(faces), faces)
    candidates, search = ipctk.Candidates(), ipctk.LBVH()
    rows = {}
    rows["find at rest ms"] = median_ms(lambda: candidates.build(mesh, rest, activation / 2, search))
    collisions = ipctk.NormalCollisions()
    rows["constraint set ms"] = median_ms(lambda: collisions.build(candidates, mesh, rest, activation))
    barrier = ipctk.BarrierPotential(activation, 1.0)
    active = max(1, len(collisions))
    rows["active pairs"] = len(collisions)
    rows["gradient ns"] = 1e6 * median_ms(lambda: barrier.gradient(collisions, mesh, rest)) / active
    clamp = ipctk.PSDProjectionMethod.CLAMP
    rows["projected Hessian ns"] = 1e6 * median_ms(lambda: barrier.hessian(collisions, mesh, rest, clamp)) / active
    rows["find on the way ms"] = median_ms(lambda: candidates.build(mesh, rest, end, activation / 2, search))
    rows["candidates"] = len(candidates)
    additive = ipctk.AdditiveCCD()
    detect = median_ms(lambda: candidates.compute_collision_free_stepsize(mesh, rest, end, 0, additive))
    rows["detection ms"] = detect
    rows["detection ns"] = 1e6 * detect / max(1, len(candidates))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("resilin", help="the program")
    parser.add_argument("--n", type=int, default=41, help="cells along an edge")
    options = parser.parse_args()
    command = [options.resilin, "bench", "collision", "--n", str(options.n), "--threads", "1", "--json"]
    ours = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    ipctk.set_num_threads(1)
    scenes = {
        "cubes face to face": (cube_surface(options.n), (0, 0, -0.6)),
        "balls": (ball_surface(options.n), (0, 0, -0.6)),
        "balls on the way": (ball_surface(options.n), (20, 0, -20)),
    }
    print(f"{'':52} {'resilin':>12} {'ipctk':>12}")
    for name, (surface, way) in scenes.items():
        for row, theirs in measure(surface, way).items():
            own = ours.get(f"{name}, {row}")
            print(f"{name + ', ' + row:52} {'' if own is None else format(own, '12.4g'):>12} {theirs:12.4g}")


if __name__ == "__main__":
    main()
