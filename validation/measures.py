"""Quantities of a run beyond the numbers in its report: values on the nodes, slopes, pressures.

A measure is a function of the report and the folder of results; `expected.json` calls it by its name.
"""

import math
import re

from frames import read_frame
from intersections import intersections, inverted_cells
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
    """Newton iterations of all steps."""
    return sum(frame["newton_iterations"] for frame in report["frames"])


def mean_velocity(report, _folder, time, axis, mass):
    """Velocity of the centre of mass of everything, along an axis; at the end where there is no time."""
    at_time = [frame for frame in report["frames"] if time is None or math.isclose(frame["time"], time, rel_tol=1e-6)]
    frame = at_time[-1]
    return frame["momentum"]["linear"][axis] / mass


def mean_acceleration(report, folder, begin, end, axis, mass):
    """Acceleration of the centre of mass of everything, along an axis between two times."""
    change = mean_velocity(report, folder, end, axis, mass) - mean_velocity(report, folder, begin, axis, mass)
    return change / (end - begin)


def time_to_stop(report, _folder, axis):
    """When the momentum along an axis, which fell evenly, is zero: from the frames above a tenth of the first."""
    momenta = [(frame["time"], frame["momentum"]["linear"][axis]) for frame in report["frames"]]
    (t0, p0), (t1, p1) = momenta[0], [entry for entry in momenta if entry[1] > 0.1 * momenta[0][1]][-1]
    return t0 + (t1 - t0) * p0 / (p0 - p1)


def sum_of_reactions(report, _folder, load, names, axis):
    """Force of boundary conditions and colliders together along an axis, at a load factor."""
    frame = next(frame for frame in report["frames"] if math.isclose(frame["load"], load, rel_tol=1e-9))
    return math.fsum(frame["reactions"][name][axis] for name in names)


def places(folder, step):
    """Where all nodes are in a frame, two or three numbers each."""
    return [[a + b for a, b in zip(rest, u, strict=True)] for rest, u in nodes(folder, step)]


def mean_place(_report, folder, step, axis):
    """Places of all nodes, each counted once, along an axis."""
    along = [place[axis] for place in places(folder, step)]
    return math.fsum(along) / len(along)


def lowest_place(_report, folder, step, axis):
    """The smallest coordinate of any node along an axis."""
    return min(place[axis] for place in places(folder, step))


def touching_times(report, name_of_collider):
    """Times of the frames in which a collider pushes by more than a tenth of the most that it does."""
    sizes = [(frame["time"], math.hypot(*frame["reactions"][name_of_collider])) for frame in report["frames"]]
    most = max(size for _, size in sizes)
    return [time for time, size in sizes if size > 0.1 * most]


def contact_duration(report, _folder, name_of_collider):
    """From the first to the last push of a collider."""
    times = touching_times(report, name_of_collider)
    return times[-1] - times[0]


def mean_contact_force(report, folder, name_of_collider, axis):
    """Impulse of a collider along an axis, over the time that it pushes."""
    momenta = [frame["momentum"]["linear"][axis] for frame in report["frames"]]
    return (momenta[-1] - momenta[0]) / contact_duration(report, folder, name_of_collider)


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


def unsolved_steps(report, _folder):
    """Steps that found no solution, as the report says; what a run that gave up did not get to counts as one."""
    if report["status"] == "done":
        return 0
    found = re.match(r"(\d+) of \d+ steps did not converge", report["reason"])
    return int(found[1]) if found else math.inf


def coordinate(report, folder, axis, which, body=None, time=None):
    """The lowest or the highest coordinate of all nodes, or of those of a body, at the end or at a time."""
    numbers = [n for n, frame in enumerate(report["frames"]) if time is None or frame["time"] <= time * (1 + 1e-9)]
    frame = read_frame(folder, numbers[-1])
    of_body = frame.nodes_of(body) if body is not None else range(len(frame.positions))
    return {"lowest": min, "highest": max}[which](frame.positions[i][axis] for i in of_body)


def energy_growth(report, _folder):
    """Most of the total energy over that at the start, in parts of the kinetic energy at the start."""
    energies = [frame["energy"] for frame in report["frames"]]
    return max(energy["total"] - energies[0]["total"] for energy in energies) / energies[0]["kinetic"]


def largest_energy_drift(report, _folder):
    """Largest change of the total energy from that at the start, over the largest kinetic energy."""
    energies = [frame["energy"] for frame in report["frames"]]
    change = max(abs(energy["total"] - energies[0]["total"]) for energy in energies)
    return change / max(energy["kinetic"] for energy in energies)


def flips(report, _folder, body, axis, count):
    """The first times at which the component of the angular velocity along an axis of a rigid body changes its sign."""
    rates = []
    for frame in report["frames"]:
        motion = frame["rigid_bodies"][body]
        rates.append((frame["time"], dot(turned(motion["rotation"], unit(axis)), motion["angular_velocity"])))
    times = []
    for (t0, before), (t1, after) in zip(rates, rates[1:], strict=False):
        if before * after < 0:
            times.append(t0 + (t1 - t0) * before / (before - after))
    return times[:count]


def time_to_turn(report, _folder, body, angle):
    """When a rigid body in the plane has turned by an angle, either way."""
    angles = []
    for frame in report["frames"]:
        w, _, _, z = frame["rigid_bodies"][body]["rotation"]
        angles.append((frame["time"], abs(2 * math.atan2(z, w))))
    for (t0, before), (t1, after) in zip(angles, angles[1:], strict=False):
        if before < angle <= after:
            return t0 + (t1 - t0) * (angle - before) / (after - before)
    return math.nan


def unit(axis):
    return [1.0 if k == axis else 0.0 for k in range(3)]


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def turned(quaternion, vector):
    """A vector turned by a quaternion (w, x, y, z)."""
    w, *axis = quaternion
    across = cross(axis, vector)
    twice = cross(axis, across)
    return [v + 2 * (w * a + b) for v, a, b in zip(vector, across, twice, strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def restitution(report, _folder, axis):
    """Speed of the centre of mass at the end over that at the start, back again."""
    momenta = [frame["momentum"]["linear"][axis] for frame in report["frames"]]
    return -momenta[-1] / momenta[0]


def probe_speed(report, _folder, probe, axis, which):
    """The lowest or highest speed of a probe along an axis in the second half of the time."""
    late = report["frames"][len(report["frames"]) // 2 :]
    speeds = [abs(frame["probes"][probe]["velocity"][axis]) for frame in late]
    return {"lowest": min, "highest": max}[which](speeds)


MEASURES = {
    function.__name__: function
    for function in (
        affine_error,
        mean_radial_displacement,
        energy_slope,
        largest_energy_change,
        largest_energy_growth,
        sum_of_reactions,
        mean_place,
        lowest_place,
        mean_velocity,
        mean_acceleration,
        time_to_stop,
        contact_duration,
        mean_contact_force,
        manufactured_error,
        newton_iterations,
        intersections,
        inverted_cells,
        unsolved_steps,
        coordinate,
        energy_growth,
        largest_energy_drift,
        flips,
        time_to_turn,
        restitution,
        probe_speed,
    )
}
