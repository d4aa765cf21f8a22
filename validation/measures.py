"""What validation reads off a run beyond numbers that stand in its report: values on the nodes, slopes, pressures.

A measure is a function of the report and the folder of results; `expected.json` calls it by its name.
"""

import array
import math
import re


def nodes(folder, step):
    """Rest positions and displacements of all nodes in a frame, each a list of three numbers."""
    data = (folder / "frames" / f"{step:04d}.vtu").read_bytes()
    head, _, appended = data.partition(b'<AppendedData encoding="raw">\n_')

    def vectors(name):
        offset = int(re.search(rb'Name="%s" NumberOfComponents="3" format="appended" offset="(\d+)"' % name, head)[1])
        size = int.from_bytes(appended[offset : offset + 8], "little")
        numbers = array.array("d", appended[offset + 8 : offset + 8 + size])
        return [numbers[i : i + 3] for i in range(0, len(numbers), 3)]

    pairs = zip(vectors(b"Points"), vectors(b"displacement"), strict=True)
    return [([x - u for x, u in zip(place, moved, strict=True)], moved) for place, moved in pairs]


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


MEASURES = {
    function.__name__: function
    for function in (
        affine_error,
        mean_radial_displacement,
        energy_slope,
        largest_energy_change,
        largest_energy_growth,
    )
}
