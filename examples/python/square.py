"""A stretched square springs back: implicit time steps by projected Newton on resilin.Elastic, with scipy."""

import numpy as np
from scipy.sparse.linalg import spsolve

import resilin

mesh = resilin.Mesh.rectangle(size=(1, 1), cells=(4, 4), pattern="alternating")
law = resilin.Material("neo_hookean", youngs_modulus=1e5, poissons_ratio=0.4)
body = resilin.Elastic(mesh, law)
M = body.mass(density=1000)
dt = 0.01  # [s]
start = mesh.positions * [1.4, 1]


def step(x, v):
    """Backward Euler: minimises 1/2 |y - x - dt v|^2_M + dt^2 E(y) and returns y and its velocity."""
    target, y = x + dt * v, x

    def objective(y):
        return 0.5 * (y - target).ravel() @ (M @ (y - target).ravel()) + dt**2 * body.value(y)

    while True:
        gradient = M @ (y - target).ravel() + dt**2 * body.gradient(y).ravel()
        p = -spsolve(M + dt**2 * body.hessian(y, projection="clamp"), gradient).reshape(y.shape)
        if np.abs(p).max() < 1e-11:  # [m]
            return y + p, (y + p - x) / dt
        t = body.max_step(y, p)  # no triangle is inverted on the way
        while objective(y + t * p) > objective(y) * (1 + 1e-14):  # but for round-off
            t /= 2
        y = y + t * p


if __name__ == "__main__":
    x, v = start, np.zeros_like(start)
    for i in range(20):
        x, v = step(x, v)
        print(f"t = {dt * (i + 1):.2f} s: width {np.ptp(x[:, 0]):.4f} m, energy {body.value(x):7.1f} J")
