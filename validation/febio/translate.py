"""The scene of a file of FEBio, and the norm of its solution."""

import collections
import warnings

import numpy as np
from curves import Curve
from materials import InexpressibleError, number, vector
from problem import Problem, RigidMotion

import resilin

TIED = ("tied-node-on-facet", "tied-facet-on-facet", "tied-elastic")
SLIDING = ("sliding-node-on-facet", "sliding-facet-on-facet", "sliding-elastic")
JOINTS = {
    "rigid joint": ("ball", None),
    "rigid spherical joint": ("ball", None),
    "rigid revolute joint": ("hinge", "rotation_axis"),
    "rigid prismatic joint": ("slider", "translation_axis"),
    "rigid cylindrical joint": ("cylindrical", "joint_axis"),
    "rigid planar joint": ("planar", "rotation_axis"),
}
GAP = 3e-4  # initial distance of bodies in contact, as a share of the extent of the scene


def rotation_matrix(v):
    angle = np.linalg.norm(v)
    if angle == 0:
        return np.eye(3)
    x, y, z = np.asarray(v) / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def centroid(positions, cells):
    """The centre of mass of hexahedra or tetrahedra with flat faces."""
    total, moment = 0, np.zeros(3)
    parts = [(0, 1, 2, 3)]
    if len(cells[0]) == 8:
        parts = [(0, 1, 3, 4), (1, 2, 3, 6), (1, 4, 5, 6), (3, 4, 6, 7), (1, 3, 4, 6)]
    for cell in cells:
        for part in parts:
            p = positions[[cell[i] for i in part]]
            volume = np.linalg.det(p[1:] - p[0]) / 6
            total += volume
            moment += volume * p.mean(axis=0)
    return moment / total


class SoftBody:
    def __init__(self, name, blocks, positions):
        self.name, self.blocks = name, blocks
        self.nodes = sorted({node for block in blocks for node in block.nodes})
        self.row = {node: i for i, node in enumerate(self.nodes)}
        self.rest = positions[self.nodes]
        self.shift = np.zeros(3)
        self.is_free = np.ones((len(self.nodes), 3), dtype=bool)
        if len({len(block.cells[0]) for block in blocks}) > 1 or len({b.has_three_fields for b in blocks}) > 1:
            raise InexpressibleError("elements of several kinds in a body")

    def table(self):
        cells = np.array([[self.row[n] for n in cell] for block in self.blocks for cell in block.cells])
        element = ("Q1P0" if self.blocks[0].has_three_fields else "Q1") if cells.shape[1] == 8 else "P1"
        mesh = resilin.Mesh(self.rest + self.shift, cells)
        material = self.blocks[0].law
        table = {"name": self.name, "mesh": mesh, "element": element, "material": material, "mass": "consistent"}
        regions = []
        for i, block in enumerate(self.blocks[1:], 1):
            nodes = {self.row[n] for n in block.nodes}
            inside = [c for b in self.blocks for c in b.cells if nodes.issuperset(self.row[n] for n in c)]
            if len(inside) != len(block.cells):
                raise InexpressibleError("a region that its nodes do not tell from others")
            regions.append({"name": f"part {i}", "where": {"vertices": sorted(nodes)}, "material": block.law})
        return table | ({"region": regions} if regions else {})


class Translation:
    """The scene of a phase, and how its result becomes FEBio's norm."""

    def __init__(self, problem, phase):
        self.problem, self.phase = problem, phase
        self.positions = np.array(problem.positions)
        self.contacts = problem.elements("Contact", phase)
        self.walls = problem.elements("Constraints", phase)
        self.has_contact = bool(self.walls) or any(c.get("type") in SLIDING for c in self.contacts)
        self.extent = float(np.ptp(self.positions, axis=0).max())
        self.soft = self.soft_bodies()
        self.owner = {node: body for body in self.soft for node in body.nodes}
        self.rigid = {
            name: RigidMotion(problem, name, phase)
            for name, material in problem.materials.items()
            if material.get("type") == "rigid body"
        }
        self.scene = {"newton": {"tolerance": 1e-11, "max_iterations": 200}}
        self.lists = collections.defaultdict(list)
        self.is_timed = (
            phase.is_dynamic or self.has_contact or any("viscoelastic" in block.law for block in problem.soft)
        )
        self.build()

    # Bodies

    def soft_bodies(self):
        """One body for all blocks, or one for each connected part where parts meet by contact or ties."""
        blocks = self.problem.soft
        if not blocks:
            return []
        if self.contacts:
            blocks = [part for block in blocks for part in block.connected_parts()]
            groups = [(set(block.nodes), [block]) for block in blocks]
            merged = []
            for nodes, members in groups:
                touching = [g for g in merged if g[0] & nodes]
                merged = [g for g in merged if g not in touching]
                merged.append((nodes.union(*(g[0] for g in touching)), [b for g in touching for b in g[1]] + members))
            groups = merged
        else:
            groups = [(set(), blocks)]
        names = ["body"] if len(groups) == 1 else [f"body {i}" for i in range(1, len(groups) + 1)]
        return [SoftBody(name, g[1], self.positions) for name, g in zip(names, groups, strict=True)]

    def build(self):
        self.choose_rigid_bodies()
        self.prescribe()
        self.fix_rigid_bodies()
        self.add_loads()
        self.add_joints()
        self.add_springs()
        self.add_linear_constraints()
        self.add_ties()
        self.add_contact()
        self.add_simulation()
        bodies = [body.table() for body in self.soft]
        for name in self.present:
            cells = self.rigid[name].cells
            nodes = sorted({n for cell in cells for n in cell})
            row = {n: i for i, n in enumerate(nodes)}
            table = np.array([[row[n] for n in cell] for cell in cells])
            mesh = resilin.Mesh(self.positions[nodes] + self.shifts[name], table)
            rigid = {"density": self.rigid[name].density} if self.phase.is_dynamic else True
            bodies.append({"name": name, "mesh": mesh, "rigid": rigid})
        bodies += self.helpers
        if not bodies:
            raise InexpressibleError("no bodies")
        if len(bodies) > 1 and not self.has_contact:
            self.scene["contact"] = {"enabled": False}
        self.scene["body"] = bodies
        self.scene |= self.lists

    def choose_rigid_bodies(self):
        """Rigid bodies that the scene has: those that may move, have joints, or meet others."""
        self.present, self.helpers, self.shifts = [], [], collections.defaultdict(lambda: np.zeros(3))
        connectors = self.connectors()
        contact_nodes = set()
        for contact in self.contacts:
            for facets in self.problem.surface_pair(contact.get("surface_pair")):
                contact_nodes.update(n for facet in facets for n in facet)
        for name, rigid in self.rigid.items():
            nodes = {n for cell in rigid.cells for n in cell}
            is_joined = any(name in (c.findtext("body_a"), c.findtext("body_b")) for c in connectors)
            meets = bool(nodes & (contact_nodes - set(self.owner)))
            is_still = rigid.is_known and not any(f(t) for f in rigid.moves.values() for t in self.phase.times[1:])
            if meets or not rigid.is_known or (is_joined and not is_still):
                if not rigid.cells:
                    if rigid.is_known:
                        continue
                    raise InexpressibleError("a rigid body without cells that may move")
                self.present.append(name)
            if rigid.centre is None and rigid.cells:
                rigid.centre = centroid(self.positions, rigid.cells)
            elif rigid.centre is not None:
                rigid.centre = np.array(rigid.centre)
                if self.phase.is_dynamic and name in self.present and not rigid.is_known:
                    offset = np.linalg.norm(rigid.centre - centroid(self.positions, rigid.cells))
                    if offset > 1e-6 * self.extent:
                        raise InexpressibleError("a rigid body in motion with another centre of mass")
            elif rigid.centre is None:
                rigid.centre = np.zeros(3)

    def connectors(self):
        return [e for e in self.problem.elements("Rigid", self.phase) if e.tag == "rigid_connector"]

    # Functions of time

    def factor(self, function):
        """(value, entry of a scene): the value at the end and, where the path counts, a table of factors."""
        end = self.phase.end
        value = function(end)
        if not self.is_timed:
            return value, {}
        times = self.phase.times
        values = [function(t) for t in times]
        values[0] = function(times[0] + 1e-9 * self.phase.step) if self.is_sudden(values) else values[0]
        largest = max(values, key=abs)
        if largest == 0:
            return 0.0, {}
        table = [[t - times[0], v / largest] for t, v in zip(times, values, strict=True)]
        return largest, {"time_function": {"table": self.thinned(table)}}

    @staticmethod
    def is_sudden(values):
        return len(set(values[1:])) == 1 and values[0] != values[1]

    @staticmethod
    def thinned(table):
        """Without points on the line through their neighbours."""
        kept = table[:1]
        for i in range(1, len(table) - 1):
            (t0, f0), (t1, f1), (t2, f2) = kept[-1], table[i], table[i + 1]
            if abs(f0 + (f2 - f0) * (t1 - t0) / (t2 - t0) - f1) > 1e-13:
                kept.append(table[i])
        return [*kept, *table[len(table) - 1 :]] if len(table) > 1 else kept

    # Boundary conditions

    def prescribe(self):
        """Fixed and prescribed displacements; nodes of rigid bodies follow them."""
        held = {}  # (node, component): function of time
        followers = collections.defaultdict(set)
        for bc in self.problem.elements("Boundary", self.phase):
            kind = bc.get("type")
            if kind == "linear constraint":
                continue
            nodes = self.problem.nodes_of(bc.get("node_set"))
            if kind == "rigid":
                followers[bc.findtext("rb")].update(nodes)
            elif kind == "zero displacement":
                for c in range(3):
                    if bc.findtext(f"{'xyz'[c]}_dof", "0") == "1":
                        held |= {(node, c): (lambda _: 0.0) for node in nodes}
            elif kind == "prescribed displacement":
                if bc.findtext("relative", "0") != "0":
                    raise InexpressibleError("relative displacements")
                function = self.problem.function(bc.find("value"))
                held |= {(node, "xyz".index(bc.findtext("dof").strip())): function for node in nodes}
            else:
                raise InexpressibleError(f"boundary condition {kind}")
        for name, rigid in self.rigid.items():
            followers[name].update(n for cell in rigid.cells for n in cell)
        self.bonded = collections.defaultdict(list)
        for name, nodes in followers.items():
            rigid = self.rigid[name]
            mine = sorted(node for node in nodes if node in self.owner)
            if not mine:
                continue
            if not rigid.is_known:
                self.bonded[name] = mine
                for node in mine:
                    self.owner[node].is_free[self.owner[node].row[node]] = False
            elif rigid.turns:
                self.rotate(rigid, mine)
            else:
                held |= {(node, c): rigid.moves["xyz"[c]] for node in mine for c in range(3)}
        self.hold(held)

    def hold(self, held):
        groups = collections.defaultdict(list)
        for (node, component), function in held.items():
            body = self.owner.get(node)
            if body is None:
                continue
            body.is_free[body.row[node], component] = False
            groups[body.name, component, id(function)].append((body.row[node], function))
        merged = collections.defaultdict(list)
        for (body, component, _), entries in groups.items():
            value, time = self.factor(entries[0][1])
            merged[body, component, value, repr(time)].append((time, [row for row, _ in entries]))
        for (body, component, value, _), entries in merged.items():
            self.lists["fix"].append(
                {
                    "name": f"fix {len(self.lists['fix'])}",
                    "body": body,
                    "where": {"vertices": sorted(row for _, rows in entries for row in rows)},
                    "components": "xyz"[component],
                    "displacement": [value * (c == component) for c in range(3)],
                    **entries[0][0],
                }
            )

    def turn(self, rigid):
        """A rotation of a scene for a known motion: a translation across the axis moves the centre."""
        translation, v = (np.array(part) for part in rigid.at(self.phase.end))
        angle = np.linalg.norm(v)
        axis = v / angle
        if abs(translation @ axis) > 1e-12 * self.extent:
            raise InexpressibleError("a rigid body that is translated along the axis of its rotation")
        # (1 - R) (c' - c) = translation
        offset = np.linalg.lstsq(np.eye(3) - rotation_matrix(v), translation, rcond=None)[0]
        centre = rigid.centre + offset
        return {"axis": axis.tolist(), "center": centre.tolist(), "degrees": float(np.degrees(angle))}

    def rotate(self, rigid, nodes):
        times = self.phase.times[1:]
        angles = [np.linalg.norm(rigid.at(t)[1]) for t in times]
        rates = {round(a / t / (angles[-1] / times[-1]), 9) for a, t in zip(angles, times, strict=True)}
        if self.phase.is_dynamic and len(rates) > 1:
            raise InexpressibleError("a rotation in dynamics that is not steady")
        by_body = collections.defaultdict(list)
        for node in nodes:
            body = self.owner[node]
            body.is_free[body.row[node]] = False
            by_body[body.name].append(body.row[node])
        for body, rows in by_body.items():
            where = {"body": body, "where": {"vertices": sorted(rows)}}
            self.lists["fix"].append({"name": f"turned {rigid.name}", **where, "rotate": self.turn(rigid)})

    def fix_rigid_bodies(self):
        for name in self.present:
            rigid = self.rigid[name]
            if rigid.is_known:
                self.fix_known(name, rigid)
            else:
                self.lead(name, rigid)
            for component, function in rigid.forces:
                value, time = self.factor(function)
                force = [value * (c == component) for c in range(3)]
                where = {"body": name, "where": "all", "point": list(map(float, rigid.centre))}
                self.lists["load"].append({"name": f"force {name}", "kind": "force", **where, "value": force, **time})

    def fix_known(self, name, rigid):
        if rigid.turns:
            turning = [tag for tag in "uvw" if any(rigid.moves[tag](t) for t in self.phase.times[1:])]
            if len(turning) == 1 and not any(rigid.moves[c](t) for c in "xyz" for t in self.phase.times[1:]):
                self.add_chain(name, rigid)  # a loop of joints may close on it
                return
            self.lists["fix"].append({"name": f"fix {name}", "body": name, "where": "all", "rotate": self.turn(rigid)})
            return
        for c in range(3):
            value, time = self.factor(rigid.moves["xyz"[c]])
            displacement = [value * (k == c) for k in range(3)]
            fix = {"name": f"fix {name} {'xyz'[c]}", "body": name, "where": "all", "components": "xyz"[c]}
            self.lists["fix"].append({**fix, "displacement": displacement, **time})

    def lead(self, name, rigid):
        """Degrees of freedom of a rigid body that are fixed, as a joint to the ground."""
        moves = rigid.moves
        if not moves:
            return
        if any(f(t) for f in moves.values() for t in self.phase.times[1:]):
            self.add_chain(name, rigid)
            return
        free = [c for c in "xyz" if c not in moves]
        turning = ["xyz"[("u", "v", "w").index(c)] for c in ("u", "v", "w") if c not in moves]
        unit = {c: [float(c == k) for k in "xyz"] for c in "xyz"}
        joint = {"name": f"lead {name}", "bodies": [name], "at": list(map(float, rigid.centre))}
        if not turning:  # pure translation
            fixed = "".join(c for c in "xyz" if c in moves)
            if len(free) == 1:
                joint |= {"kind": "slider", "axis": unit[free[0]]}
                self.lists["joint"].append(joint)
                return
            raise InexpressibleError(f"a rigid body that may translate across {fixed} without rotation")
        kinds = {(0, 3): "ball", (0, 1): "hinge", (1, 1): "cylindrical", (2, 1): "planar"}
        kind = kinds.get((len(free), len(turning)))
        if kind is None:
            raise InexpressibleError(f"a rigid body with {len(free)} free translations and {len(turning)} rotations")
        if kind == "cylindrical" and free != turning:
            # A planar joint, and the centre stays on a line in this plane.
            across = next(c for c in "xyz" if c not in (*free, *turning))
            kind = "planar"
            self.on_line(name, rigid, across)
        if kind == "planar" and len(free) == 2 and turning[0] in free:
            raise InexpressibleError("a rigid body that turns about an axis in its plane of motion")
        self.lists["joint"].append(joint | {"kind": kind} | ({} if kind == "ball" else {"axis": unit[turning[0]]}))

    def add_chain(self, name, rigid):
        """Prescribed and free degrees of freedom: sliders along the axes and a hinge, with bodies between them."""

        def acts(tag):
            return tag not in rigid.moves or any(rigid.moves[tag](t) for t in self.phase.times[1:])

        turning = [axis for axis, tag in zip("xyz", "uvw", strict=True) if acts(tag)]
        if len(turning) > 1:
            raise InexpressibleError("a rigid body with several prescribed rotations")
        links = [("slider", axis, axis) for axis in "xyz" if acts(axis)]
        links += [("hinge", axis, "uvw"["xyz".index(axis)]) for axis in turning]
        before = []
        at = list(map(float, rigid.centre))
        for i, (kind, axis, tag) in enumerate(links):
            to = name if i == len(links) - 1 else f"{name} {i}"
            if to != name:
                mesh = {"box": {"size": [self.extent / 10] * 3, "cells": [1, 1, 1], "origin": at}}
                self.helpers.append({"name": to, "mesh": mesh, "rigid": True})
            unit = [float(c == axis) for c in "xyz"]
            joint = {"name": f"{kind} {to}", "kind": kind, "bodies": [*before, to], "at": at, "axis": unit}
            if tag in rigid.moves:
                value, time = self.factor(rigid.moves[tag])
                joint["motor"] = {"position": value, **time}
            self.lists["joint"].append(joint)
            before = [to]

    def on_line(self, name, rigid, component):
        nodes = sorted({n for cell in rigid.cells for n in cell})
        mean = self.positions[nodes].mean(axis=0)
        if np.linalg.norm(mean - rigid.centre) > 1e-9 * self.extent:
            raise InexpressibleError("a rigid body whose centre is not the mean of its nodes")
        term = {"body": name, "where": "all", "component": component}
        self.lists["constraint"].append({"name": f"line {name}", "kind": "equation", "terms": [term]})

    # Loads

    def facets_by_body(self, facets):
        found = collections.defaultdict(list)
        for facet in facets:
            if all(node in self.owner for node in facet):
                found[self.owner[facet[0]].name].append(facet)
        return found

    def add_loads(self):
        self.gravity = [0.0, 0.0, 0.0]
        for load in self.problem.elements("Loads", self.phase):
            kind = load.get("type")
            if kind in ("nodal_force", "nodal_load"):
                self.add_nodal_force(load, kind)
            elif kind == "pressure":
                self.add_pressure(load)
            elif kind == "traction":
                value, time = self.factor(self.problem.function(load.find("scale")))
                traction = [value * part for part in vector(load.findtext("traction"))]
                self.add_surface_load(load, {"kind": "traction", "value": traction, **time})
            elif kind == "const":
                for c in range(3):
                    element = load.find("xyz"[c])
                    value, time = self.factor(self.problem.function(element)) if element is not None else (0.0, {})
                    if self.phase.is_dynamic and value != 0 and any(f != 1 for _, f in time["time_function"]["table"]):
                        raise InexpressibleError("gravity that varies in motion")
                    self.gravity[c] = -value
            else:
                raise InexpressibleError(f"load {kind}")

    def add_surface_load(self, load, entry):
        for body, facets in self.facets_by_body(self.problem.surface(load.get("surface"))).items():
            row = next(b for b in self.soft if b.name == body).row
            nodes = sorted({row[n] for facet in facets for n in facet})
            name = f"load {len(self.lists['load'])}"
            self.lists["load"].append({"name": name, "body": body, "where": {"vertices": nodes}, **entry})

    def add_pressure(self, load):
        element = load.find("pressure")
        if load.findtext("linear", "0") != "0":
            raise InexpressibleError("dead pressure")
        if element.get("type") == "math":
            self.add_pressure_by_formula(load, element)
            return
        value, time = self.factor(self.problem.function(element))
        self.add_surface_load(load, {"kind": "pressure", "value": value, **time})

    def add_pressure_by_formula(self, load, element):
        """A polynomial of X, Y, Z: its mean over each facet, by Gauss points."""
        formula = element.text
        if set(formula) - set("0123456789.+-*/() XYZ"):
            raise InexpressibleError("pressure by a formula with functions")
        factor = self.problem.curve(element.get("lc"))(self.phase.end) if element.get("lc") else 1.0
        offset = 0.5 / np.sqrt(3)
        for body, facets in self.facets_by_body(self.problem.surface(load.get("surface"))).items():
            row = next(b for b in self.soft if b.name == body).row
            for facet in facets:
                corners = self.positions[facet]
                values, forces = [], np.zeros((len(facet), 3))
                for r in (0.5 - offset, 0.5 + offset):
                    for s in (0.5 - offset, 0.5 + offset):
                        weights = np.array([(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s])
                        x = weights @ corners if len(facet) == 4 else corners.mean(axis=0)
                        values.append(eval(formula, {}, dict(zip("XYZ", x, strict=True))))  # noqa: S307 - digits alone
                        forces += np.outer(weights, self.area(corners)) / 4 * values[-1]
                self.add_difference(body, [row[n] for n in facet], factor * self.even(forces, np.mean(values), corners))
                entry = {"kind": "pressure", "value": factor * float(np.mean(values))}
                name = f"load {len(self.lists['load'])}"
                where = {"vertices": sorted(row[n] for n in facet)}
                self.lists["load"].append({"name": name, "body": body, "where": where, **entry})

    @staticmethod
    def area(corners):
        """Area times outward normal of a facet that is a parallelogram."""
        return np.cross(corners[1] - corners[0], corners[3] - corners[0])

    def even(self, forces, mean, corners):
        """The nodal forces of a pressure that varies, less those of its mean: small, and therefore dead loads."""
        return -(forces - mean * np.outer(np.full(len(corners), 0.25), self.area(corners)))

    def add_difference(self, body, rows, forces):
        for row, force in zip(rows, forces, strict=True):
            name = f"load {len(self.lists['load'])}"
            where = {"body": body, "where": {"vertices": [row]}}
            self.lists["load"].append({"name": name, "kind": "nodal_force", **where, "value": force.tolist()})

    def add_nodal_force(self, load, kind):
        if kind == "nodal_load":
            value, time = self.factor(self.problem.function(load.find("scale")))
            force = [value * (c == load.findtext("dof").strip()[-1]) for c in "xyz"]
        else:
            element = load.find("value")
            factor, time = 1.0, {}
            if element.get("lc"):
                factor, time = self.factor(self.problem.curve(element.get("lc")))
            force = [factor * part for part in vector(element.text)]
        for node in self.problem.nodes_of(load.get("node_set")):
            body = self.owner[node]
            where = {"body": body.name, "where": {"vertices": [body.row[node]]}}
            name = f"load {len(self.lists['load'])}"
            self.lists["load"].append({"name": name, "kind": "nodal_force", **where, "value": force, **time})

    # Joints, springs, ties

    def add_joints(self):
        for name, nodes in self.bonded.items():
            for node in nodes:
                at = self.positions[node].tolist()
                bodies = [name, self.owner[node].name]
                self.lists["joint"].append({"name": f"bond {node}", "kind": "ball", "bodies": bodies, "at": at})
        for i, connector in enumerate(self.connectors()):
            kind = connector.get("type")
            pair = [connector.findtext("body_a"), connector.findtext("body_b")]
            bodies = [name for name in pair if name in self.present]
            if not bodies:
                continue
            if kind == "rigid spring":
                points = []
                for name, tag in zip(pair, ("insertion_a", "insertion_b"), strict=True):
                    owner = {"body": name} if name in self.present else {}
                    points.append(owner | {"at": vector(connector.findtext(tag))})
                spring = {"name": f"spring {i}", "points": points, "stiffness": number(connector, "k")}
                if number(connector, "free_length", 0) != 0:
                    spring["rest_length"] = number(connector, "free_length", 0)
                self.lists["spring"].append(spring)
            elif kind in JOINTS:
                self.add_joint(f"joint {i}", kind, connector, pair, bodies)
            else:
                raise InexpressibleError(f"rigid bodies with {kind}")

    def add_joint(self, name, kind, connector, pair, bodies):
        ours, axis_tag = JOINTS[kind]
        at = vector(connector.findtext("joint_origin") or connector.findtext("joint"))
        joint = {"name": name, "kind": ours, "bodies": bodies, "at": at}
        if axis_tag:
            joint["axis"] = vector(connector.findtext(axis_tag))
        sign = 1 if bodies[-1] == pair[1] else -1
        for tag in ("force", "moment", "force_damping", "moment_damping"):
            if connector.find(tag) is not None and number(connector, tag, 0) != 0:
                raise InexpressibleError(f"a joint with {tag}")
        motors = {}
        for tag, prescribed in (("rotation", "prescribed_rotation"), ("translation", "prescribed_translation")):
            if connector.findtext(prescribed, "0") == "1":
                value, time = self.factor(self.problem.function(connector.find(tag)))
                motors[tag] = {"position": sign * value, **time}
        if ours == "cylindrical" and len(motors) == 2 and len(bodies) == 1:
            # A body between them: it slides, and the other one turns on it.
            between = f"{name} between"
            mesh = {"box": {"size": [self.extent / 10] * 3, "cells": [1, 1, 1], "origin": at}}
            self.helpers.append({"name": between, "mesh": mesh, "rigid": True})
            slide = {"name": f"{name} slide", "kind": "slider", "bodies": [between], "motor": motors["translation"]}
            turn = {"name": name, "kind": "hinge", "bodies": [between, *bodies], "motor": motors["rotation"]}
            self.lists["joint"] += [joint | slide, joint | turn]
            return
        if motors and ours not in ("hinge", "slider"):
            raise InexpressibleError(f"a motor in a {kind}")
        for motor in motors.values():
            joint["motor"] = motor
        self.lists["joint"].append(joint)

    def add_springs(self):
        """Springs between nodes; a node of no cell is a point of the ground."""
        problem = self.problem
        materials = {m.get("id"): m for m in problem.root.findall("./Discrete/discrete_material")}
        for discrete in problem.root.findall("./Discrete/discrete"):
            material = materials[discrete.get("dmat")]
            force = self.force_of_spring(material)
            for pair in problem.root.findall(f"./Mesh/DiscreteSet[@name='{discrete.get('discrete_set')}']/*"):
                points = []
                for node in problem.indices(pair.text):
                    owner = {"body": self.owner[node].name} if node in self.owner else {}
                    points.append(owner | {"at": problem.positions[node]})
                spring = {"points": points, **force}
                if points[0]["at"] == points[1]["at"]:
                    spring["rest_length"] = 0
                self.lists["spring"].append(spring)

    @staticmethod
    def force_of_spring(material):
        """Keys of a spring: a stiffness, or a table of forces along a curve with its ends."""
        kind = material.get("type")
        if kind == "linear spring":
            return {"stiffness": number(material, "E")}
        force = material.find("force")
        if kind != "nonlinear spring" or material.findtext("measure", "elongation") != "elongation" or force is None:
            raise InexpressibleError(f"Discrete: {kind}")
        curve, scale = Curve(force), number(material, "scale", 1)
        first, last = curve.points[0][0], curve.points[-1][0]
        if curve.interpolation == "STEP" or curve.extension not in ("CONSTANT", "EXTRAPOLATE"):
            raise InexpressibleError(f"Discrete: {kind} with steps or repetitions")
        if first == last:
            raise InexpressibleError(f"Discrete: {kind} by one point")
        elongations = [point[0] for point in curve.points]
        if curve.interpolation != "LINEAR":
            elongations = np.union1d(elongations, np.linspace(first, last, 1001))
        rows = [[float(e), scale * curve(float(e))] for e in elongations]
        if curve.extension == "CONSTANT":
            rows = [[first - (last - first), rows[0][1]], *rows, [last + (last - first), rows[-1][1]]]
        return {"forces": rows}

    def add_linear_constraints(self):
        for bc in self.problem.root.findall("./Boundary/bc[@type='linear constraint']"):
            if float(bc.findtext("offset", "0")) != 0:
                raise InexpressibleError("a linear constraint with an offset")

            def term(element, coefficient):
                node = self.problem.ids[element.findtext("node").strip()]
                body, component = self.owner[node], element.findtext("dof").strip()
                where = {"body": body.name, "where": {"vertices": [body.row[node]]}}
                return {**where, "component": component, "coefficient": coefficient}

            terms = [term(bc, 1.0)]
            terms += [term(child, -float(child.findtext("value"))) for child in bc.findall("child_dof")]
            self.lists["constraint"].append({"kind": "equation", "terms": terms})
            body = next(b for b in self.soft if b.name == terms[0]["body"])
            body.is_free[terms[0]["where"]["vertices"][0], "xyz".index(terms[0]["component"])] = False

    def side(self, facets):
        body = self.owner[facets[0][0]]
        return {"body": body.name, "where": {"vertices": sorted({body.row[n] for facet in facets for n in facet})}}

    def add_ties(self):
        for contact in self.contacts:
            if contact.get("type") not in TIED:
                continue
            primary, secondary = self.problem.surface_pair(contact.get("surface_pair"))
            surfaces = [self.side(primary), self.side(secondary)]
            self.lists["tie"].append({"name": contact.get("name"), "surfaces": surfaces})

    # Contact

    def add_contact(self):
        for contact in self.contacts:
            if contact.get("type") not in (*SLIDING, *TIED):
                raise InexpressibleError(f"Contact: {contact.get('type')}")
        if not self.has_contact:
            return
        gap = GAP * self.extent
        friction = [number(c, "fric_coeff", 0) for c in self.contacts if c.get("type") in SLIDING]
        self.scene["contact"] = {"activation_distance": gap, "friction": max(friction, default=0)}
        for wall in self.walls:
            self.add_wall(wall, gap)
        if any(c.get("type") in SLIDING for c in self.contacts):
            self.part_bodies(gap)

    def add_wall(self, wall, gap):
        *normal, distance = vector(wall.findtext("plane"))
        length = np.linalg.norm(normal)
        normal = np.array(normal) / length
        value, time = self.factor(self.problem.function(wall.find("offset")))
        point = distance / length * normal - gap * normal
        collider = {"name": wall.get("name"), "kind": "half_space", "normal": normal.tolist(), "point": point.tolist()}
        collider |= {"activation_distance": gap}
        if value != 0:
            collider |= {"displacement": ((value + gap) * normal).tolist(), **time}
        self.lists["collider"].append(collider)

    def part_bodies(self, gap):
        """Bodies must start apart: the one that moves first starts farther back and moves farther."""
        movers = [(b.name, fix) for b in self.soft for fix in self.lists["fix"] if fix.get("body") == b.name]
        movers += [(n, fix) for n in self.present for fix in self.lists["fix"] if fix.get("body") == n]
        for name, fix in movers:
            table = fix.get("time_function", {"table": [[0, 0], [self.phase.duration, 1]]})["table"]
            displacement = np.array(fix.get("displacement", [0, 0, 0]))
            if not displacement.any():
                continue
            first = next((f for t, f in table if f != 0), 0)
            t_first = next((t for t, f in table if f != 0), 0)
            if t_first > table[1][0] + 1e-12:
                continue  # it moves later
            direction = np.sign(first) * displacement / np.linalg.norm(displacement)
            soft = next((b for b in self.soft if b.name == name), None)
            if soft is not None:
                if soft.shift.any():
                    continue
                soft.shift = -gap * direction
            else:
                self.shifts[name] = -gap * direction

    # Simulation

    def add_simulation(self):
        phase = self.phase
        if phase.is_dynamic:
            times = {"time_step": phase.step, "end_time": phase.duration}
            self.scene["simulation"] = {"kind": "dynamic", "integrator": phase.integrator, **times}
        else:
            steps = 10 if not self.is_timed else phase.num_steps
            self.scene["simulation"] = {"kind": "static", "load_steps": steps, "end_time": phase.duration}
            if any("viscoelastic" in block.law for block in self.problem.soft):
                self.scene["simulation"]["load_steps"] = max(steps, 1000)
            if self.present:
                self.scene["simulation"]["load_steps"] = max(steps, phase.num_steps)
        self.scene["simulation"]["gravity"] = self.gravity

    # Norm

    def rigid_unknowns(self, report):
        """Translations and rotation vectors of rigid bodies; turns are counted up to two, as quaternions do."""
        found = []
        for name in self.present:
            rigid = self.rigid[name]
            if rigid.is_known:
                continue
            frames = [frame["rigid_bodies"][name] for frame in report["frames"]]
            quaternions = [np.array(frame["rotation"]) for frame in frames]
            for i in range(1, len(quaternions)):
                if quaternions[i] @ quaternions[i - 1] < 0:
                    quaternions[i] = -quaternions[i]
            w, v = quaternions[-1][0], quaternions[-1][1:]
            length = np.linalg.norm(v)
            angle = 2 * np.arctan2(length, w)
            vector_of_rotation = v / length * angle if length > 0 else np.array([2 * np.arctan2(0.0, w), 0, 0])
            start, end = (np.array(frame["position"]) for frame in (frames[0], frames[-1]))
            turn = rotation_matrix(vector_of_rotation)
            translation = end + turn @ (rigid.centre - start) - rigid.centre
            unknowns = dict(zip("xyzuvw", (*translation, *vector_of_rotation), strict=True))
            if length == 0 and w < 0:  # one whole turn: along the free axis
                free = [tag for tag in "uvw" if tag not in rigid.moves]
                unknowns |= dict.fromkeys("uvw", 0.0) | {free[0]: angle}
            found += [value for tag, value in unknowns.items() if tag not in rigid.moves]
        return found

    def displacements(self, result):
        end = np.asarray(result.positions[-1])
        return {body.name: end[result.vertices(body.name)] - body.rest for body in self.soft}

    def norm(self, result):
        parts = [self.displacements(result)[body.name][body.is_free] for body in self.soft]
        return float(np.linalg.norm(np.concatenate([*parts, np.array(self.rigid_unknowns(result.report))])))


def translations(path):
    problem = Problem(path)
    found = [Translation(problem, phase) for phase in problem.phases]
    if len(found) > 1 and (any(t.present for t in found) or any(t.phase.is_dynamic for t in found[:-1])):
        raise InexpressibleError("several steps")
    return found


def norm_of(path):
    """A static step may come before others: its positions are the initial ones of the next step."""
    before = None
    for translation in translations(path):
        if before is not None:
            for table in translation.scene["body"]:
                table["initial_positions"] = before[table["name"]]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = resilin.run(translation.scene)
        if result.report["status"] != "done":
            raise RuntimeError(result.report["reason"])
        positions = np.asarray(result.positions[-1])
        before = {body.name: positions[result.vertices(body.name)].tolist() for body in translation.soft}
    return translation.norm(result)
