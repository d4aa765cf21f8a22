"""How far a computed displacement field is from an exact one: norms integrated over straight-sided simplices."""

import functools
import itertools
import math

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
    """Values of the shape functions, and their derivatives by each barycentric coordinate."""
    corners = len(barycentric)
    if num_nodes == corners:
        return barycentric, [[float(i == k) for k in range(corners)] for i in range(corners)]
    values = [b * (2 * b - 1) for b in barycentric]
    slopes = [[(4 * b - 1) * (i == k) for k in range(corners)] for i, b in enumerate(barycentric)]
    for i, j in EDGES[: num_nodes - corners]:
        values.append(4 * barycentric[i] * barycentric[j])
        slopes.append([4 * (barycentric[j] * (k == i) + barycentric[i] * (k == j)) for k in range(corners)])
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
        moved = [frame.displacements[node] for node in cell]
        gradients, volume = barycentric_gradients(rest[: dim + 1], dim)
        for values, slopes, weight in reference[len(cell)]:
            place = [sum(n * x[k] for n, x in zip(values, rest, strict=True)) for k in range(dim)]
            u, du = exact(place)
            slopes_x = [
                [sum(s * g[k] for s, g in zip(slope, gradients, strict=True)) for k in (0, 1)] for slope in slopes
            ]
            for i in range(dim):
                difference = sum(n * v[i] for n, v in zip(values, moved, strict=True)) - u[i]
                value_error += volume * weight * difference**2
            for i, k in itertools.product((0, 1), repeat=2):
                difference = sum(s[k] * v[i] for s, v in zip(slopes_x, moved, strict=True)) - du[i][k]
                slope_error += volume * weight * difference**2
    return math.sqrt(value_error), math.sqrt(slope_error)
