"""One Neo-Hookean triangle against the textbook's formulas, computed with 50 digits.

Source: Li, Jiang & Luo, Physics-based simulation, 15.2 (Psi, its polar SVD, the 2 by 2 blocks of dP/dF and their
projection). The program printed there fills `np.array([[0, 0, 0, 0]] * 4)`, an array of whole numbers, with the blocks
M of dP/dF and with dP/dF itself, and so cuts off the fractions of both: at E = 1 nearly nothing is left of the Hessian,
at E = 1e5 five digits. Here nothing is cut off.
"""

# ruff: noqa: N803, N806 - F, U, V, B, M and J are the letters of the source

from decimal import Decimal, localcontext
from itertools import product

import numpy as np
import pytest

import resilin

DIGITS = 50
TWO_BY_TWO = list(product(range(2), repeat=2))

TRIANGLES = {
    "right": [[0, 0], [1, 0], [0, 1]],
    "slanted": [[0.2, -0.1], [1.3, 0.4], [0.5, 0.9]],
    "narrow": [[0, 0], [1, 0.02], [0.45, 0.11]],
    "a millimetre wide": [[1e-3, 0], [2e-3, 4e-4], [1.3e-3, 1.1e-3]],
}
STATES = {  # deformation gradients
    "stretched": [[1.6, 0], [0, 0.9]],
    "stretched aslant": [[1.4, 0.3], [0.3, 1.1]],
    "sheared": [[1, 0.8], [0, 1]],
    "squashed to J = 0.05 one way": [[0.05, 0], [0, 1]],
    "squashed to J = 0.05 both ways": [[0.05**0.5, 0], [0, 0.05**0.5]],
    "squashed and sheared": [[0.9, 0.7], [0.25, 0.25]],
    "blown up evenly": [[2, 0], [0, 2]],
    "turned by 100 degrees and stretched": [[-0.2, -1.1], [1.3, -0.15]],
    "turned and squashed": [[0.1, 0.6], [-0.5, 0.08]],
    "near rest": [[1.02, 0.03], [-0.01, 0.97]],
}


def exact(matrix):
    return [[Decimal(float(entry)) for entry in row] for row in matrix]


def multiply(A, B):
    return [[sum(a * b for a, b in zip(row, column, strict=True)) for column in zip(*B, strict=True)] for row in A]


def determinant(A):
    return A[0][0] * A[1][1] - A[0][1] * A[1][0]


def inverse(A):
    J = determinant(A)
    return [[A[1][1] / J, -A[0][1] / J], [-A[1][0] / J, A[0][0] / J]]


def without_negative_eigenvalues(a, b, c):
    """[[a, b], [b, c]] with its negative eigenvalues set to zero: (sum I + difference D / radius) / 2."""
    mean, half = (a + c) / 2, (a - c) / 2
    radius = (half * half + b * b).sqrt()
    upper, lower = max(mean + radius, Decimal(0)), max(mean - radius, Decimal(0))
    middle, scale = (upper + lower) / 2, (upper - lower) / (2 * radius) if radius else 0
    return middle + scale * half, scale * b, middle - scale * half


def polar_svd(F):
    """F = U diag(s) V^T with rotations U and V, for det F > 0: F = R S, and the eigenvectors of S."""
    cosine, sine = F[0][0] + F[1][1], F[1][0] - F[0][1]
    length = (cosine * cosine + sine * sine).sqrt()
    R = [[cosine / length, -sine / length], [sine / length, cosine / length]]
    (p, q), (_, r) = multiply([list(row) for row in zip(*R, strict=True)], F)
    mean, radius = (p + r) / 2, (((p - r) / 2) ** 2 + q * q).sqrt()
    s = mean + radius, mean - radius
    first = max((p - s[1], q), (q, r - s[1]), key=norm) if radius else (Decimal(1), Decimal(0))
    x, y = (entry / norm(first) for entry in first)
    V = [[x, -y], [y, x]]
    return multiply(R, V), s, V


def norm(vector):
    return sum(entry * entry for entry in vector).sqrt()


def energy_density(F, mu, lam):
    ln_J = determinant(F).ln()
    return mu / 2 * (sum(F[i][j] ** 2 for i, j in TWO_BY_TWO) - 2) - mu * ln_J + lam / 2 * ln_J**2


def stress(F, mu, lam):
    ln_J, F_inv = determinant(F).ln(), inverse(F)
    return [[mu * (F[i][j] - F_inv[j][i]) + lam * ln_J * F_inv[j][i] for j in range(2)] for i in range(2)]


def stress_tangent(F, mu, lam, is_projected):
    """{(i, j, k, l): dP_ij/dF_kl}."""
    U, s, V = polar_svd(F)
    ln_J = (s[0] * s[1]).ln()
    slope = [mu * (s_a - 1 / s_a) + lam * ln_J / s_a for s_a in s]
    curvature = [mu * (1 + 1 / s_a**2) - lam * (ln_J - 1) / s_a**2 for s_a in s]
    stretches = curvature[0], lam / (s[0] * s[1]), curvature[1]
    B_left = (mu + (mu - lam * ln_J) / (s[0] * s[1])) / 2
    B_right = (slope[0] + slope[1]) / (2 * max(s[0] + s[1], Decimal("1e-6")))
    B = B_left + B_right, B_left - B_right, B_left + B_right
    if is_projected:
        stretches, B = without_negative_eigenvalues(*stretches), without_negative_eigenvalues(*B)
    M = {}  # between the directions u_a v_b^T
    for (first, second), block in ((((0, 0), (1, 1)), stretches), (((1, 0), (0, 1)), B)):
        M[first, first], M[first, second], M[second, second] = block
        M[second, first] = M[first, second]
    return {
        (i, j, k, m): sum(M[(a, b), (c, d)] * U[i][a] * V[j][b] * U[k][c] * V[m][d] for (a, b), (c, d) in M)
        for i, j, k, m in product(range(2), repeat=4)
    }


def triangle(X, x, youngs_modulus, poissons_ratio, is_projected):
    """Energy, gradient (6,) and Hessian (6, 6) of one triangle, rounded to double once, at the end."""
    with localcontext() as context:
        context.prec = DIGITS
        X, x, E, nu = exact(X), exact(x), Decimal(youngs_modulus), Decimal(poissons_ratio)
        mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
        Dm, Ds = ([[p[a][i] - p[0][i] for a in (1, 2)] for i in range(2)] for p in (X, x))
        IB, volume = inverse(Dm), determinant(Dm) / 2
        F = multiply(Ds, IB)
        P, A = stress(F, mu, lam), stress_tangent(F, mu, lam, is_projected)
        dN = [[-IB[0][j] - IB[1][j] for j in range(2)], *IB]  # gradients of the three shape functions
        unknowns = list(product(range(3), range(2)))
        gradient = [volume * sum(P[i][j] * dN[a][j] for j in range(2)) for a, i in unknowns]
        hessian = [
            [volume * sum(A[i, j, k, m] * dN[a][j] * dN[b][m] for j, m in TWO_BY_TWO) for b, k in unknowns]
            for a, i in unknowns
        ]
        energy = volume * energy_density(F, mu, lam)
        return float(energy), np.array(gradient, dtype=float), np.array(hessian, dtype=float)


def assert_equal(ours, theirs):
    """To 1e-12 of the largest entry."""
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())


def deformed(X, F):
    """Moved as well, so that nothing rests on a corner that stays where it was."""
    return np.asarray(X, dtype=float) @ np.transpose(F) + np.array([0.25, -0.5]) * np.ptp(X)


@pytest.mark.parametrize("poissons_ratio", [-0.3, 0.0, 0.3, 0.49])
@pytest.mark.parametrize("youngs_modulus", [1.0, 1e5])
@pytest.mark.parametrize("shape", TRIANGLES)
def test_a_triangle_is_that_of_the_textbook(shape, youngs_modulus, poissons_ratio):
    X = TRIANGLES[shape]
    law = resilin.Material("neo_hookean", youngs_modulus=youngs_modulus, poissons_ratio=poissons_ratio)
    body = resilin.Elastic(resilin.Mesh(X, [[0, 1, 2]]), law)
    for F in STATES.values():
        x = deformed(X, F)
        for projection in (None, "clamp"):
            energy, gradient, hessian = triangle(X, x, youngs_modulus, poissons_ratio, projection == "clamp")
            assert_equal(body.hessian(x, projection).toarray(), hessian)
        assert_equal(body.gradient(x).ravel(), gradient)
        assert body.value(x) == pytest.approx(energy, rel=1e-12)


def test_the_states_give_the_projection_something_to_do():
    X = TRIANGLES["slanted"]
    changed = []
    for name, F in STATES.items():
        plain, clamped = (triangle(X, deformed(X, F), 1.0, 0.3, is_projected)[2] for is_projected in (False, True))
        if np.abs(plain - clamped).max() > 1e-3 * np.abs(plain).max():
            changed.append(name)
    assert len(changed) >= 3, changed
    assert len(changed) < len(STATES)


def test_the_singular_values_of_the_textbook_give_back_the_state():
    for F in STATES.values():
        with localcontext() as context:
            context.prec = DIGITS
            U, s, V = polar_svd(exact(F))
            back = [[sum(U[i][a] * s[a] * V[j][a] for a in range(2)) for j in range(2)] for i in range(2)]
            assert all(abs(back[i][j] - Decimal(float(F[i][j]))) < Decimal("1e-48") for i, j in TWO_BY_TWO)
            assert determinant(U) > 0 < determinant(V)


def test_the_gradient_of_the_textbook_is_the_slope_of_its_energy():
    """And its Hessian that of its gradient: what is compared with is right in itself."""
    X, F = TRIANGLES["slanted"], STATES["squashed and sheared"]
    x, h = deformed(X, F), 1e-6
    _, gradient, hessian = triangle(X, x, 1.0, 0.3, False)
    for unknown in range(6):
        step = np.zeros(6)
        step[unknown] = h
        ahead, behind = (triangle(X, x + sign * step.reshape(3, 2), 1.0, 0.3, False) for sign in (1, -1))
        assert (ahead[0] - behind[0]) / (2 * h) == pytest.approx(gradient[unknown], rel=1e-6)
        slope = (ahead[1] - behind[1]) / (2 * h)
        np.testing.assert_allclose(slope, hessian[unknown], rtol=0, atol=1e-6 * np.abs(hessian).max())
