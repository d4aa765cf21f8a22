"""A cube on a held face falls for 13 steps of 1/60 s: error against time, beside Newton's VBD and MuJoCo's flex.

    pip install newton mujoco        # beside the resilin package
    python benchmarks/python/view_peers.py [--cells 10]

The cube has 0.4 m edges, 1000 kg/m^3, E = 0.1 MPa, nu = 0.4. Resilin and VBD see the same tetrahedra (those of Newton's
grid, five for each small cube) and the same energy, stable neo-Hookean; MuJoCo makes its own grid, of six, with its own
law. Every method runs on one thread; times are of the process, without set-up, per step. Errors are root mean squares
over the vertices, as shares of the displacement: against the method's own solved steps (what cutting short costs), and
against the lowest point of Resilin's solved steps (what one would see).
"""

import argparse
import time

import numpy as np

EDGE, DENSITY, YOUNG, POISSON = 0.4, 1000.0, 1e5, 0.4
STEP, STEPS = 1 / 60, 13


class Row:
    """One way to run the cube: where its vertices ended and what a step took."""

    def __init__(self, name, rest, end, milliseconds, note=""):
        self.name, self.rest, self.end, self.milliseconds, self.note = name, rest, end, milliseconds, note

    def sag(self):
        return EDGE - (EDGE + self.end[:, 2].min() - self.rest[:, 2].min())


def median_step(step):
    times = []
    for _ in range(STEPS):
        start = time.process_time()
        step()
        times.append(1e3 * (time.process_time() - start))
    return float(np.median(times))


def newton_grid(cells):
    """The model of Newton's grid, its left face held."""
    import newton
    import warp

    builder = newton.ModelBuilder(up_axis="Z")
    mu = YOUNG / (2 * (1 + POISSON))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    size = EDGE / cells
    builder.add_soft_grid(
        pos=warp.vec3(0, 0, 0),
        rot=warp.quat_identity(),
        vel=warp.vec3(0, 0, 0),
        **{f"dim_{axis}": cells for axis in "xyz"},
        **{f"cell_{axis}": size for axis in "xyz"},
        density=DENSITY,
        k_mu=mu,
        k_lambda=lame + mu,
        k_damp=0.0,
        fix_left=True,
        add_surface_mesh_edges=False,
    )
    builder.color()
    model = builder.finalize(device="cpu")
    share_mass(model)
    return model


def share_mass(model):
    """Gives each particle its share of its tetrahedra; the grid gives each that of a small cube, a third more."""
    places, cells = model.particle_q.numpy().astype(float), model.tet_indices.numpy().reshape(-1, 4)
    edges = places[cells[:, 1:]] - places[cells[:, :1]]
    mass = np.zeros(len(places))
    np.add.at(mass, cells, np.abs(np.linalg.det(edges))[:, None] * DENSITY / 24)
    mass[model.particle_inv_mass.numpy() == 0] = 0
    model.particle_mass.assign(mass.astype(np.float32))
    model.particle_inv_mass.assign(np.divide(1, mass, out=np.zeros_like(mass), where=mass > 0).astype(np.float32))


def run_vbd(cells, sweeps):
    from newton.solvers import SolverVBD

    model = newton_grid(cells)
    solver = SolverVBD(model, iterations=sweeps)
    before, after, control = model.state(), model.state(), model.control()
    rest = before.particle_q.numpy().copy()
    states = [before, after]

    def step():
        states[0].clear_forces()
        solver.step(states[0], states[1], control, None, STEP)
        states.reverse()

    milliseconds = median_step(step)
    return Row(f"Newton VBD, {sweeps} sweeps", rest, states[0].particle_q.numpy(), milliseconds)


def run_mujoco(cells):
    import mujoco

    n, size = cells + 1, EDGE / cells
    xml = f"""<mujoco>
      <option timestep="{STEP}" integrator="discrete" solver="CG" gravity="0 0 -9.81"/>
      <size memory="500M"/>
      <worldbody>
        <flexcomp name="cube" type="grid" dim="3" count="{n} {n} {n}" spacing="{size} {size} {size}"
          mass="{DENSITY * EDGE**3}" radius="0.001" pos="{EDGE / 2} {EDGE / 2} {EDGE / 2}">
          <contact selfcollide="none" contype="0" conaffinity="0"/>
          <elasticity young="{YOUNG}" poisson="{POISSON}"/>
          <pin gridrange="0 0 0 0 {n - 1} {n - 1}"/>
        </flexcomp>
      </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rest = data.flexvert_xpos.copy()
    milliseconds = median_step(lambda: mujoco.mj_step(model, data))
    return Row("MuJoCo flex, one linear solve", rest, data.flexvert_xpos.copy(), milliseconds, "another law and grid")


def run_resilin(cells, title, **options):
    import resilin

    model = newton_grid(cells)
    vertices = model.particle_q.numpy().astype(float)
    tetrahedra = model.tet_indices.numpy().reshape(-1, 4)
    scene = {
        "simulation": {"kind": "dynamic", "gravity": [0, 0, -9.81], "time_step": STEP, "end_time": STEP * STEPS},
        "body": [
            {
                "name": "cube",
                "mesh": resilin.Mesh(vertices, tetrahedra),
                "element": "P1",
                "material": {
                    "law": "stable_neo_hookean",
                    "youngs_modulus": YOUNG,
                    "poissons_ratio": POISSON,
                    "density": DENSITY,
                },
            }
        ],
        "fix": [{"name": "face", "where": {"plane": {"axis": "x", "at": 0}}}],
        "newton": options,
    }
    simulation = resilin.Simulation(scene)
    milliseconds = median_step(simulation.step)
    return Row(f"Resilin, {title}", vertices, simulation.positions.copy(), milliseconds)


def rms_share(row, solved):
    """Distance to the solved run as a share of its displacement."""
    return float(np.linalg.norm(row.end - solved.end) / np.linalg.norm(solved.end - solved.rest))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=10, help="small cubes along an edge")
    cells = parser.parse_args().cells

    import resilin

    resilin.set_num_threads(1)
    ours = run_resilin(cells, "solved to 1e-10", tolerance=1e-10)
    vbd = run_vbd(cells, 1000)
    groups = [
        (ours, [ours]),
        (ours, [run_resilin(cells, f"solved to {t:g}", tolerance=t) for t in (1e-4, 1e-3, 1e-2)]),
        (ours, [run_resilin(cells, "one iteration", tolerance=1e-10, max_iterations=1)]),
        (vbd, [vbd]),
        (vbd, [run_vbd(cells, sweeps) for sweeps in (10, 50, 200)]),
        (None, [run_mujoco(cells)]),
    ]
    print(f"{5 * cells**3:,} tetrahedra, {(cells + 1) ** 3:,} vertices, {STEPS} steps of 1/60 s, one thread")
    print(f"{'method':34} {'ms/step':>8} {'error of cutting short':>23} {'sag [m]':>9} {'off our sag':>12}")
    for solved, rows in groups:
        for row in rows:
            share = "" if solved is None else f"{rms_share(row, solved):.1e}"
            off = abs(row.sag() / ours.sag() - 1)
            print(f"{row.name:34} {row.milliseconds:8.2f} {share:>23} {row.sag():9.4f} {off:11.1%}  {row.note}")


if __name__ == "__main__":
    main()
