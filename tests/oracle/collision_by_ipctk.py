"""Distances, times of collision, barriers, friction and candidates beside ipctk 1.6 (MIT licence), case by case.

    pip install ipctk numpy
    python tests/oracle/collision_by_ipctk.py build/release/tests/oracle/collision_numbers
    python tests/oracle/collision_by_ipctk.py PROGRAM --cases 1000000    # some minutes

A quarter of the cases each are pairs of points, points and edges, points and triangles, and edges: random ones and such
as are on a grid, nearly of no length, nearly parallel, of 1e-6 or 1e6 times the size, aimed at each other, or move
nearly together. What must hold, else the exit code is 1:

- distances, relative to the size of the pair: 1e-7, the square root of what ipctk's squares of products can tell
- gradients and barriers of pairs that are well shaped: 1e-8 and 1e-7 relative; times the condition, for Hessians
- times of collision are no later than the touch that tight inclusion finds
- friction: 1e-12
- of random surfaces on their way, each pair of boxes that brute force finds is a candidate
"""

import argparse
import subprocess
import sys

import ipctk
import numpy as np

KINDS = {"point_point": 2, "point_edge": 3, "point_triangle": 4, "edge_edge": 4}
FAMILIES = ("random", "grid", "short", "parallel", "tiny", "huge", "aimed", "together")
CCD_TOLERANCE = 1e-7


def ask(program, *what, numbers):
    data = np.concatenate([np.ravel(part).astype(float) for part in numbers]).tobytes()
    done = subprocess.run([program, *what], input=data, stdout=subprocess.PIPE, check=True)
    return np.frombuffer(done.stdout)


def sample(random, count, n):
    """x, p (count, n, 3), the activation distance of each and the number of its family."""
    x, p = random.uniform(-1, 1, (count, n, 3)), random.uniform(-2, 2, (count, n, 3))
    family = np.arange(count) % len(FAMILIES)
    of = {name: family == i for i, name in enumerate(FAMILIES)}
    x[of["grid"]], p[of["grid"]] = np.round(2 * x[of["grid"]]), np.round(2 * p[of["grid"]])
    x[of["short"], -1] = x[of["short"], -2] + 1e-9 * x[of["short"], -1]
    if n > 2:
        g = of["parallel"]
        along = 0.7 * (x[g, 1] - x[g, 0])
        x[g, -1] = x[g, -2] + along + 10.0 ** random.uniform(-16, 0, (g.sum(), 1)) * x[g, -1]
    g = of["aimed"]
    p[g, 0] += x[g, -1] + p[g, -1] - x[g, 0] - p[g, 0]
    g = of["together"]
    p[g] = p[g, :1] + 1e-3 * p[g]
    size = np.where(of["tiny"], 1e-6, np.where(of["huge"], 1e6, 1.0))
    return x * size[:, None, None], p * size[:, None, None], size * random.uniform(0.5, 4, count), family


class Worst:
    """The largest errors, and what went beyond its tolerance."""

    def __init__(self):
        self.errors, self.problems = {}, []

    def see(self, what, error, tolerance, case):
        if not error <= self.errors.get(what, -1.0):
            self.errors[what] = error
        if not error <= tolerance:
            self.problems.append(f"{what}: {error:.2e}, more than {tolerance:.0e}; {case}")


def relative(a, b):
    return np.abs(a - b).max() / max(np.abs(b).max(), 1e-300)


def compare_derivatives(name, x, activation, ours, worst, case):
    """`ours`: gradient of the distance, barrier, its gradient, its Hessian times v."""
    size = 3 * len(x)
    d = np.sqrt(getattr(ipctk, f"{name}_distance")(*x))
    if not 1e-2 < d < activation:
        return
    slope = getattr(ipctk, f"{name}_distance_gradient")(*x).ravel() / (2 * d)
    curve = getattr(ipctk, f"{name}_distance_hessian")(*x) / (2 * d) - np.outer(slope, slope) / d
    b, scale = ipctk.ClampedLogBarrier(), 1 / activation  # theirs has one length more
    first, second = scale * b.first_derivative(d, activation), scale * b.second_derivative(d, activation)
    v = np.array([(i + 1) * (-1) ** i for i in range(size)]) / 10
    hessian = second * np.outer(slope, slope) + first * curve
    worst.see(f"{name}: gradient of the distance", relative(ours[:size], slope), 1e-8, case)
    value = scale * b(d, activation)
    worst.see(f"{name}: barrier", abs(ours[size] - value) / (value + 1e-9), 1e-7, case)
    worst.see(f"{name}: gradient", np.abs(ours[size + 1 : 2 * size + 1] - first * slope).max(), 1e-7, case)
    bound = np.abs(second * np.outer(slope, slope)).max() + np.abs(first) * np.abs(curve).max()
    worst.see(f"{name}: Hessian", np.abs(ours[2 * size + 1 :] - hessian @ v).max() / (bound + 1e-9), 1e-7, case)


def closest_until(distance, x, p, end):
    """The smallest distance on the way up to a time: where theirs runs out of iterations it is early by much."""
    return np.sqrt(max(0, min(distance(*(x + t * p)) for t in np.linspace(0, end, 1000))))


def compare_pairs(program, name, count, random, worst):
    n = KINDS[name]
    x, p, activation, family = sample(random, count, n)
    packed = np.hstack([x.reshape(count, -1), p.reshape(count, -1), activation[:, None]])
    ours = ask(program, "pairs", name, numbers=[packed]).reshape(count, -1)
    distance = getattr(ipctk, f"{name}_distance")
    detect = getattr(ipctk.TightInclusionCCD(CCD_TOLERANCE, 100_000, 1.0), f"{name}_ccd")
    touches = 0
    for i in range(count):
        case = f"{name}, {FAMILIES[family[i]]}, x = {x[i].tolist()}, p = {p[i].tolist()}"
        size = max(np.abs(x[i]).max(), 1e-300)
        expected = np.sqrt(max(distance(*x[i]), 0))
        no_length = n > 2 and family[i] in (1, 2)  # pairs of which ipctk makes lines
        if not no_length:
            worst.see(f"{name}: distance", abs(ours[i, 2] - expected) / size, 1e-7, case)
        worst.see(f"{name}: distance in lanes", abs(np.sqrt(ours[i, 1]) - ours[i, 2]) / size, 1e-7, case)
        if FAMILIES[family[i]] in ("random", "aimed", "together"):
            compare_derivatives(name, x[i], activation[i], ours[i, 3:], worst, case)
        unit = {"tiny": 1e6, "huge": 1e-6}.get(FAMILIES[family[i]], 1.0)  # its tolerance is a length
        hit, time = detect(*(unit * x[i]), *(unit * (x[i] + p[i])))
        if hit:
            touches += 1
            is_late = ours[i, 0] > time + 1e-6 and closest_until(distance, x[i], p[i], ours[i, 0]) < 0.05 * expected
            worst.see(f"{name}: later than the touch", float(is_late), 0, case)
    return touches


def compare_friction(program, count, random, worst):
    slips = random.uniform(-1, 1, (count, 2)) * 10.0 ** random.uniform(-8, 2, (count, 1))
    speeds = 10.0 ** random.uniform(-6, 0, count)
    ours = ask(program, "friction", numbers=[np.hstack([slips, speeds[:, None]])]).reshape(-1, 3)
    for u, eps, (energy, *force) in zip(slips, speeds, ours, strict=True):
        y, case = np.hypot(*u), f"slip {u.tolist()}, {eps}"
        expected = ipctk.smooth_friction_f1_over_x(y, eps) * u
        worst.see("friction: force", np.abs(force - expected).max(), 1e-12, case)
        f0 = ipctk.smooth_friction_f0(y, eps) - ipctk.smooth_friction_f0(0, eps)
        worst.see("friction: energy", abs(energy - f0) / (eps + y), 1e-12, case)


def compare_candidates(program, random, worst):
    """Two crumpled sheets and a soup of triangles, that move."""
    n = int(random.integers(3, 9))
    grid = np.array([[i, j, 0] for i in range(n) for j in range(n)]) / n
    corner = [i * n + j for i in range(n - 1) for j in range(n - 1)]
    sheet = [t for a in corner for t in ([a, a + 1, a + n], [a + 1, a + n + 1, a + n])]
    parts = [(grid, sheet), (grid, sheet), (random.uniform(0, 1, (3 * n, 3)), np.arange(3 * n).reshape(-1, 3))]
    x, faces, bodies, first = [], [], [], 0
    for body, (places, triangles) in enumerate(parts):
        x.append(places + random.uniform(-0.2, 0.2, 3) + random.choice([0, 0.1]) * random.standard_normal(places.shape))
        faces.append(np.array(triangles) + first)
        bodies += [body] * len(places)
        first += len(places)
    x, faces = np.vstack(x), np.vstack(faces)
    x = np.round(8 * x) / 8 if random.uniform() < 0.3 else x  # ties
    p = random.choice([0, 0.05, 1]) * random.standard_normal(x.shape)
    edges, near = ipctk.edges(faces), 10.0 ** random.uniform(-4, -1)
    mesh, theirs = ipctk.CollisionMesh(x, edges, faces), ipctk.Candidates()
    theirs.build(mesh, x, x + p, near / 2 * (1 - 1e-9), ipctk.BruteForce())
    head = [len(x), len(edges), len(faces), near]
    ours = ask(program, "candidates", numbers=[head, bodies, edges, faces, x, p])
    num_edges, pairs = int(ours[0]), ours[2:].reshape(-1, 2).astype(int)
    found_edges = {tuple(sorted(pair)) for pair in pairs[:num_edges].tolist()}
    found_faces = set(map(tuple, pairs[num_edges:].tolist()))
    wanted_edges = {tuple(sorted((c.edge0_id, c.edge1_id))) for c in theirs.ee_candidates}
    wanted_faces = {(c.vertex_id, c.face_id) for c in theirs.fv_candidates}
    missed = len(wanted_edges - found_edges) + len(wanted_faces - found_faces)
    worst.see("candidates missed", missed, 0, f"{len(x)} vertices, distance {near}")
    return len(wanted_edges) + len(wanted_faces)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="collision_numbers of the build folder")
    parser.add_argument("--cases", type=int, default=8000, help="pairs in all; default 8000, a few seconds")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    ipctk.set_logger_level(ipctk.LoggerLevel.error)
    random, worst, touches, candidates = np.random.default_rng(options.seed), Worst(), 0, 0
    share, part = options.cases // len(KINDS), 25_000
    for name in KINDS:
        for begin in range(0, share, part):
            touches += compare_pairs(options.program, name, min(part, share - begin), random, worst)
    compare_friction(options.program, share, random, worst)
    surfaces = max(10, options.cases // 2000)
    for _ in range(surfaces):
        candidates += compare_candidates(options.program, random, worst)
    print(f"{len(KINDS) * share} pairs, {touches} touch on their way; {share} slips")
    print(f"{surfaces} surfaces, {candidates} pairs of boxes by brute force")
    for what, error in worst.errors.items():
        print(f"{what:44} {error:.2e}")
    for problem in worst.problems[:20]:
        print(f"FAILED  {problem}")
    if len(worst.problems) > 20:
        print(f"... and {len(worst.problems) - 20} more")
    return 1 if worst.problems else 0


if __name__ == "__main__":
    sys.exit(main())
