"""How far a computed displacement field is from an exact one: norms integrated over straight-sided simplices."""

import functools
import itertools
import math
import operator

from frames import read_frame

# Gauss-Legendre, 6 points on [0, 1], exact to degree 11 (Abramowitz & Stegun, table 25.4).
POINTS = [
    0.5 + 0.5 * sign * x for x in (0.2386191860831969, 0.6612093864662645, 0.9324695142031521) for sign in (-1, 1)
]
WEIGHTS = [0.5 * w for w in (0.4679139345726910, 0.3607615730481386, 0.1713244923791704) for _ in (0, 1)]
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # order of VTK's nodes in the middle of edges


def simplex_rule(dim):
    """[(barycentric coordinates, weight)] on the collapsed square or cube; the weights add up to 1."""
    rule = []
    for indices in itertools.product(range(len(POINTS)), repeat=dim):
        barycentric, rest, weight = [], 1.0, float(math.factorial(dim))
        for depth, i in enumerate(indices):
            barycentric.append(rest * POINTS[i])
            weight *= WEIGHTS[i] * (1 - POINTS[i]) ** (dim - 1 - depth)
            rest *= 1 - POINTS[i]
        rule.append(([rest, *barycentric], weight))
    return rule


def shapes(barycentric, num_nodes):
    """Values of the shape functions, and for each barycentric coordinate their derivatives by it."""
    corners = range(len(barycentric))
    if num_nodes == len(barycentric):
        return barycentric, [[float(i == k) for i in corners] for k in corners]
    edges = EDGES[: num_nodes - len(barycentric)]
    values = [b * (2 * b - 1) for b in barycentric] + [4 * barycentric[i] * barycentric[j] for i, j in edges]
    slopes = []
    for k in corners:
        of_corners = [(4 * barycentric[i] - 1) * (i == k) for i in corners]
        of_edges = [4 * (barycentric[j] * (i == k) + barycentric[i] * (j == k)) for i, j in edges]
        slopes.append(of_corners + of_edges)
    return values, slopes


def barycentric_gradients(corners, dim):
    """d(barycentric coordinate)/dX of a simplex, and its volume."""
    edges = [[corner[k] - corners[0][k] for k in range(dim)] for corner in corners[1:]]
    if dim == 2:
        (a, b), (c, d) = edges
        determinant = a * d - b * c
        inverse = [[d, -b], [-c, a]]
    else:
        crosses = [cross(edges[(i + 1) % 3], edges[(i + 2) % 3]) for i in range(3)]
        determinant = sum(a * b for a, b in zip(edges[0], crosses[0], strict=True))
        inverse = [list(column) for column in zip(*crosses, strict=True)]
    gradients = [[inverse[k][i] / determinant for k in range(dim)] for i in range(dim)]
    first = [-sum(gradient[k] for gradient in gradients) for k in range(dim)]
    return [first, *gradients], abs(determinant) / math.factorial(dim)


def dot(a, b):
    return sum(map(operator.mul, a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


@functools.lru_cache(maxsize=16)  # rows ask for one norm after the other
def error_norms(folder, step, dim, exact):
    """L2 norm of u - exact, and the L2 norm of the gradient of its x and y components by x and y.

    `exact(X)` returns the displacement and the 2 x 2 matrix of those derivatives.
    """
    frame = read_frame(folder, step)
    rule = simplex_rule(dim)
    reference = {count: [(*shapes(point, count), weight) for point, weight in rule] for count in map(len, frame.cells)}
    value_error = slope_error = 0.0
    for cell in frame.cells:
        rest = [frame.rest[node] for node in cell]
        moved = list(zip(*(frame.displacements[node] for node in cell), strict=True))[:dim]
        gradients, volume = barycentric_gradients(rest[: dim + 1], dim)
        rest = list(zip(*rest, strict=True))[:dim]
        for values, slopes, weight in reference[len(cell)]:
            u, du = exact([dot(values, x) for x in rest])
            for found, wanted in zip(moved, u, strict=False):
                value_error += volume * weight * (dot(values, found) - wanted) ** 2
            for found, wanted in zip(moved[:2], du, strict=True):
                by_barycentric = [dot(slope, found) for slope in slopes]
                for k in (0, 1):
                    slope = sum(s * gradient[k] for s, gradient in zip(by_barycentric, gradients, strict=True))
                    slope_error += volume * weight * (slope - wanted[k]) ** 2
    return math.sqrt(value_error), math.sqrt(slope_error)
