"""What validation reads off a run beyond numbers that stand in its report: values on the nodes, slopes, pressures.

A measure is a function of the report and the folder of results; `expected.json` calls it by its name.
"""

import math

from frames import read_frame
from norms import error_norms


def nodes(folder, step):
    """Pairs of rest position and displacement of all nodes in a frame."""
    frame = read_frame(folder, step)
    return zip(frame.rest, frame.displacements, strict=True)


def affine_error(report, folder, gradient):
    """Largest distance of a node in the last frame from X + gradient X."""
    dim = len(gradient)
    largest = 0.0
    for rest, u in nodes(folder, report["frames"][-1]["step"]):
        exact = [sum(gradient[i][k] * rest[k] for k in range(dim)) for i in range(dim)]
        largest = max(largest, math.dist(u[:dim], exact))
    return largest


def mean_radial_displacement(report, folder, radius, load):
    """Mean of u . X / |X| over the nodes at the distance `radius` from the origin, at a load factor."""
    frame = next(frame for frame in report["frames"] if math.isclose(frame["load"], load, rel_tol=1e-9))
    values = []
    for rest, u in nodes(folder, frame["step"]):
        distance = math.hypot(*rest)
        if math.isclose(distance, radius, rel_tol=1e-9):
            values.append(sum(a * b for a, b in zip(u, rest, strict=True)) / distance)
    return math.fsum(values) / len(values)


def energy_slope(report, _folder, load, spacing, stretch):
    """d(elastic energy)/d(stretch * load factor) by five points `spacing` apart: off by spacing^4 / 30 d^5E."""

    def energy(offset):
        wanted = load + offset * spacing
        frame = next(frame for frame in report["frames"] if math.isclose(frame["load"], wanted, rel_tol=1e-9))
        return frame["energy"]["elastic"]

    difference = energy(-2) - 8 * energy(-1) + 8 * energy(1) - energy(2)
    return difference / (12 * spacing * stretch)


def largest_energy_change(report, _folder):
    """Largest |E - E_0| / E_0 of the total energy over all frames."""
    energies = [frame["energy"]["total"] for frame in report["frames"]]
    return max(abs(energy - energies[0]) for energy in energies) / energies[0]


def largest_energy_growth(report, _folder):
    """Largest step upwards of the total energy from frame to frame; negative when each step loses some."""
    energies = [frame["energy"]["total"] for frame in report["frames"]]
    return max(after - before for before, after in zip(energies, energies[1:], strict=False))


def newton_iterations(report, _folder):
    """Of all steps."""
    return sum(frame["newton_iterations"] for frame in report["frames"])


def manufactured_displacement(place):
    """Displacement [m] of the manufactured solution, and the derivatives of its x and y components by x and y."""
    x, a, b = math.pi * place[0], 0.15, 0.2
    slopes = [[a * math.pi * math.cos(x), 0.0], [b * math.pi * math.cos(x), 0.0]]
    return [a * math.sin(x), b * math.sin(x), 0.0], slopes


def manufactured_error(report, folder, norm, dim, coarser=None):
    """Norm ("L2", or "H1" of derivatives by x and y) of the error in the last frame of the manufactured case.

    With `coarser`, the error on a mesh twice as coarse: the order log2(coarser / error).
    """
    l2, h1 = error_norms(folder, report["frames"][-1]["step"], dim, manufactured_displacement)
    error = {"L2": l2, "H1": h1}[norm]
    return error if coarser is None else math.log2(coarser / error)


MEASURES = {
    function.__name__: function
    for function in (
        affine_error,
        mean_radial_displacement,
        energy_slope,
        largest_energy_change,
        largest_energy_growth,
        manufactured_error,
        newton_iterations,
    )
}
