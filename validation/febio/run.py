#!/usr/bin/env python3
"""Translates problems of FEBio's test suite, runs them and compares a norm of the displacements.

RESILIN_SHARED=FOLDER validation/febio/run.py              every problem of FOLDER/febio that can be expressed
RESILIN_SHARED=FOLDER validation/febio/run.py --only ma    problems whose name contains the text
RESILIN_SHARED=FOLDER validation/febio/run.py --json FILE  writes a line for each problem, too

The norm is the l2 norm of all free displacements at the end of the last step. FEBio stops early by default, so that
some of its norms hold to 1e-6 or 1e-4 only. The files are read where they are.
"""

import argparse
import collections
import json
import os
import pathlib
import warnings
import xml.etree.ElementTree as ElementTree

import numpy as np

import resilin


class InexpressibleError(Exception):
    """A feature that this translation, or Resilin, lacks."""


def number(element, name, default=None):
    found = element.find(name)
    if found is None:
        if default is None:
            raise InexpressibleError(f"{element.tag} without {name}")
        return default
    if found.get("lc"):
        raise InexpressibleError(f"{name} that varies in time")
    if found.get("type"):
        raise InexpressibleError(f"{name} of type {found.get('type')}")
    return float(found.text)


def vector(text):
    return [float(part) for part in text.split(",")]


def volumetric(bulk_modulus):
    """U = k/2 (ln J)^2 of the uncoupled materials."""
    return {"law": "neo_hookean_isochoric_log", "bulk_modulus": bulk_modulus}


def axes(material):
    axis = material.find("mat_axis")
    if axis is None:
        return [[1, 0, 0], [0, 1, 0]]
    if axis.get("type") != "vector":
        raise InexpressibleError(f"mat_axis of type {axis.get('type')}")
    return [vector(axis.find("a").text), vector(axis.find("d").text)]


def ogden(material):
    terms = []
    for i in range(1, 7):
        c, m = number(material, f"c{i}", 0), number(material, f"m{i}", 1)
        if c != 0:
            terms.append((c / m, m))
    if len(terms) > 3:
        raise InexpressibleError("Ogden with more than three terms")
    constants = {}
    for i, (mu, alpha) in enumerate(terms, 1):
        constants |= {f"mu_{i}": mu, f"alpha_{i}": alpha}
    return {"sum": [{"law": "ogden", **constants}, volumetric(number(material, "k"))]}


def viscoelastic(material):
    """Shares g_i of the long-term moduli beside g0 = 1; the whole stress relaxes."""
    if number(material, "g0", 1) != 1:
        raise InexpressibleError("viscoelastic with g0 other than 1")
    law, _ = law_of(material.find("elastic"))
    branches = [(number(material, f"g{i}", 0), number(material, f"t{i}", 1)) for i in range(1, 7)]
    branches = [branch for branch in branches if branch[0] != 0]
    series = {"g": [g for g, _ in branches], "tau": [tau for _, tau in branches]}
    return {**law, "viscoelastic": {**series, "moduli": "long_term", "formulation": "whole"}}


def law_of(material):
    """(material of a scene, whether FEBio's hexahedra have three fields)."""
    kind = material.get("type")

    def get(name, default=None):
        return number(material, name, default)

    if kind == "neo-Hookean":
        return {"law": "neo_hookean", "youngs_modulus": get("E"), "poissons_ratio": get("v")}, False
    if kind == "isotropic elastic":
        return {"law": "saint_venant_kirchhoff", "youngs_modulus": get("E"), "poissons_ratio": get("v")}, False
    if kind == "Holmes-Mow":
        moduli = {"youngs_modulus": get("E"), "poissons_ratio": get("v")}
        return {"law": "holmes_mow", **moduli, "stiffening": get("beta")}, False
    if kind == "coupled Mooney-Rivlin" and get("c2") == 0:
        return {"law": "neo_hookean", "shear_modulus": 2 * get("c1"), "lame_lambda": get("k")}, False
    if kind == "orthotropic elastic":
        names = {"E1": "youngs_modulus_1", "E2": "youngs_modulus_2", "E3": "youngs_modulus_3"}
        for pair in ("12", "23", "31"):
            names |= {f"G{pair}": f"shear_modulus_{pair}", f"v{pair}": f"poissons_ratio_{pair}"}
        constants = {ours: get(theirs) for theirs, ours in names.items()}
        return {"law": "orthotropic", **constants, "fibres": axes(material)}, False
    if kind == "viscoelastic":
        return viscoelastic(material), False
    if material.findtext("pressure_model", "default") not in ("default", "0"):
        raise InexpressibleError("another pressure_model")
    if kind == "Mooney-Rivlin":
        shape = {"law": "mooney_rivlin", "c10": get("c1"), "c01": get("c2", 0)}
        return {"sum": [shape, volumetric(get("k"))]}, True
    if kind == "Yeoh":
        if any(get(f"c{i}", 0) != 0 for i in (4, 5, 6)):
            raise InexpressibleError("Yeoh with more than three terms")
        shape = {"law": "yeoh", "c10": get("c1"), "c20": get("c2", 0), "c30": get("c3", 0)}
        return {"sum": [shape, volumetric(get("k"))]}, True
    if kind == "Ogden":
        return ogden(material), True
    raise InexpressibleError(f"material {kind}")


class Problem:
    def __init__(self, path):
        self.path = path
        self.root = ElementTree.parse(path).getroot()
        self.ids = {}
        self.positions = []
        for block in self.root.findall("./Mesh/Nodes"):
            for node in block:
                self.ids[node.get("id")] = len(self.positions)
                self.positions.append(vector(node.text))
        self.node_sets = {
            s.get("name"): [self.ids[i.strip()] for i in (s.text or "").split(",") if i.strip()]
            for s in self.root.findall("./Mesh/NodeSet")
        }
        control = self.root.find("Control")
        if control is None:
            raise InexpressibleError("several steps")
        self.is_dynamic = control.findtext("analysis", "STATIC").strip().upper() == "DYNAMIC"
        rhoi = control.findtext("solver/rhoi")
        if self.is_dynamic and rhoi not in ("-2", "1"):
            raise InexpressibleError("generalised-alpha method")
        # The generalised-alpha method of spectral radius 1 is the implicit midpoint rule.
        self.integrator = "newmark" if rhoi == "-2" else "midpoint"
        self.num_steps = int(control.findtext("time_steps"))
        self.step = float(control.findtext("step_size"))
        self.end = self.num_steps * self.step
        self.refuse_what_is_missing()

    def refuse_what_is_missing(self):
        for section in ("Contact", "Constraints", "Initial", "Step", "MeshAdaptor", "MeshData"):
            found = self.root.find(section)
            if found is not None and len(found):
                raise InexpressibleError(
                    f"{section}: {', '.join(sorted({str(e.get('type') or e.tag) for e in found}))}"
                )
        for kind in ("ShellDomain", "BeamDomain"):
            if self.root.find(f"./MeshDomains/{kind}") is not None:
                raise InexpressibleError(kind)

    def value_at_end(self, element):
        """The number of an element, times its load curve at the end."""
        if element.get("type") not in (None, "const"):
            raise InexpressibleError(f"{element.tag} of type {element.get('type')}")
        value, curve = float(element.text), element.get("lc")
        if curve is None or value == 0:
            return value
        for controller in self.root.findall("./LoadData/load_controller"):
            if controller.get("id") == curve:
                return value * self.curve_at_end(controller)
        raise InexpressibleError("load curve that is missing")

    def curve_at_end(self, controller):
        if controller.get("type") != "loadcurve":
            raise InexpressibleError(f"load controller {controller.get('type')}")
        points = [vector(point.text) for point in controller.find("points")]
        times = [point[0] for point in points]
        if self.root.find("./Material/material[@type='viscoelastic']") is not None:
            if len({point[1] for point in points}) > 1:
                raise InexpressibleError("a viscoelastic solid under a load that varies")
            return points[0][1]
        if self.is_dynamic:
            values = {point[1] for point in points if point[0] > 0}
            if controller.findtext("interpolate") != "STEP" and len({point[1] for point in points}) > 1:
                raise InexpressibleError("motion under a load that varies")
            return values.pop()
        if self.end >= times[-1] - 1e-12:
            if controller.findtext("extend", "CONSTANT") != "CONSTANT" and self.end > times[-1] + 1e-9:
                raise InexpressibleError("load curve that repeats or is extrapolated")
            return points[-1][1]
        if controller.findtext("interpolate") == "LINEAR" or min(abs(self.end - t) for t in times) < 1e-12:
            return float(np.interp(self.end, times, [point[1] for point in points]))
        raise InexpressibleError("smooth load curve that ends early")

    def domains(self):
        """[(material of a scene or None for rigid ones, whether three fields, cells)]."""
        materials = {m.get("name"): m for m in self.root.findall("./Material/material")}
        blocks = {e.get("name"): e for e in self.root.findall("./Mesh/Elements")}
        found = []
        for domain in self.root.findall("./MeshDomains/SolidDomain"):
            material, block = materials[domain.get("mat")], blocks[domain.get("name")]
            if block.get("type") not in ("hex8", "tet4"):
                raise InexpressibleError(f"elements {block.get('type')}")
            if domain.get("type", "elastic-solid") not in ("elastic-solid", "three-field-solid"):
                raise InexpressibleError(f"domain {domain.get('type')}")
            cells = [[self.ids[i.strip()] for i in cell.text.split(",")] for cell in block]
            if material.get("type") == "rigid body":
                found.append((None, material.get("name"), cells))
            else:
                law, is_mixed = law_of(material)
                law["density"] = number(material, "density", 1)
                has_three_fields = is_mixed if domain.get("type") is None else "three" in domain.get("type")
                found.append((law, has_three_fields and block.get("type") == "hex8", cells))
        return found

    def nodes_of(self, name):
        if name is None:
            raise InexpressibleError("a boundary condition without node_set")
        if name.startswith("@surface:"):
            nodes = set()
            for facet in self.surface(name.removeprefix("@surface:")):
                nodes.update(facet)
            return sorted(nodes)
        if name not in self.node_sets:
            raise InexpressibleError(f"node set {name}")
        return self.node_sets[name]

    def surface(self, name):
        for surface in self.root.findall("./Mesh/Surface"):
            if surface.get("name") == name:
                return [[self.ids[i.strip()] for i in facet.text.split(",")] for facet in surface]
        raise InexpressibleError(f"surface {name}")

    def prescribed(self, rigid_nodes):
        """{(node, component): displacement at the end}."""
        held = {}
        for bc in self.root.findall("./Boundary/bc"):
            kind = bc.get("type")
            if kind == "linear constraint":  # see linear_constraints
                continue
            if kind == "rigid":
                for node in self.nodes_of(bc.get("node_set")):
                    rigid_nodes.setdefault(bc.findtext("rb"), set()).add(node)
                continue
            nodes = self.nodes_of(bc.get("node_set"))
            if kind == "zero displacement":
                moves = [(c, 0.0) for c in range(3) if bc.findtext(f"{'xyz'[c]}_dof", "0") == "1"]
            elif kind == "prescribed displacement":
                if bc.findtext("relative", "0") != "0":
                    raise InexpressibleError("relative displacements")
                moves = [("xyz".index(bc.findtext("dof").strip()), self.value_at_end(bc.find("value")))]
            else:
                raise InexpressibleError(f"boundary condition {kind}")
            for component, value in moves:
                held |= {(node, component): value for node in nodes}
        for name, nodes in rigid_nodes.items():
            moves = self.rigid_motion(name)
            held |= {(node, c): moves[c] for node in nodes for c in range(3)}
        return held

    def rigid_motion(self, name):
        """The translation of a rigid body whose every degree of freedom is prescribed."""
        moves = {}
        for bc in self.root.findall("./Rigid/*"):
            if bc.findtext("rb") != name:
                continue
            if bc.get("type") == "rigid_fixed":
                for tag in ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw"):
                    if bc.findtext(f"{tag}_dof", "0") == "1":
                        moves[tag[1]] = 0.0
            elif bc.get("type") == "rigid_displacement":
                moves[bc.findtext("dof").strip()[-1].lower()] = self.value_at_end(bc.find("value"))
            else:
                raise InexpressibleError(f"rigid bodies with {bc.get('type')}")
        if not {"x", "y", "z", "u", "v", "w"} <= moves.keys():
            raise InexpressibleError("rigid bodies that are free to move, bonded to soft ones")
        return [moves["x"], moves["y"], moves["z"]]

    def springs(self, row):
        """Linear springs between nodes; a node of no cell is a point of the ground."""
        materials = {m.get("id"): m for m in self.root.findall("./Discrete/discrete_material")}
        springs = []
        for discrete in self.root.findall("./Discrete/discrete"):
            material = materials[discrete.get("dmat")]
            if material.get("type") != "linear spring":
                raise InexpressibleError(f"Discrete: {material.get('type')}")
            for pair in self.root.findall(f"./Mesh/DiscreteSet[@name='{discrete.get('discrete_set')}']/*"):
                nodes = [self.ids[i.strip()] for i in pair.text.split(",")]
                points = [{"body": "body"} if node in row else {} for node in nodes]
                for point, node in zip(points, nodes, strict=True):
                    point["at"] = self.positions[node]
                springs.append({"points": points, "stiffness": number(material, "E")})
        return springs

    def linear_constraints(self, row):
        """(constraints of a scene, components that they determine)."""
        constraints, determined = [], set()
        for bc in self.root.findall("./Boundary/bc[@type='linear constraint']"):
            if float(bc.findtext("offset", "0")) != 0:
                raise InexpressibleError("a linear constraint with an offset")

            def term(element, coefficient):
                vertex = row[self.ids[element.findtext("node").strip()]]
                component = element.findtext("dof").strip()
                where = {"vertices": [vertex]}
                return {"body": "body", "where": where, "component": component, "coefficient": coefficient}

            terms = [term(bc, 1.0)]
            terms += [term(child, -float(child.findtext("value"))) for child in bc.findall("child_dof")]
            constraints.append({"kind": "equation", "terms": terms})
            determined.add((terms[0]["where"]["vertices"][0], "xyz".index(terms[0]["component"])))
        return constraints, determined

    def loads(self):
        loads = []
        for load in self.root.findall("./Loads/*"):
            kind = load.get("type")
            if kind in ("nodal_force", "nodal_load"):
                force = self.nodal_force(load, kind)
                nodes = self.nodes_of(load.get("node_set"))
                for node in nodes:
                    loads.append({"kind": "nodal_force", "where": {"vertices": [node]}, "value": force})
            elif kind == "pressure":
                value = self.value_at_end(load.find("pressure"))
                if load.findtext("linear", "0") != "0":
                    raise InexpressibleError("dead pressure")
                loads.append({"kind": "pressure", "surface": self.surface(load.get("surface")), "value": value})
            elif kind == "const":
                value = [self.value_at_end(load.find(c)) if load.find(c) is not None else 0 for c in "xyz"]
                loads.append({"kind": "gravity", "value": [-v for v in value]})
            else:
                raise InexpressibleError(f"load {kind}")
        return loads

    def nodal_force(self, load, kind):
        if kind == "nodal_load":
            value = self.value_at_end(load.find("scale"))
            return [value * (c == load.findtext("dof").strip()[-1]) for c in "xyz"]
        value = load.find("value")
        factor = 1.0
        if value.get("lc"):
            one = ElementTree.Element("one", {"lc": value.get("lc")})
            one.text = "1"
            factor = self.value_at_end(one)
        return [factor * part for part in vector(value.text)]

    def regions(self, soft, row):
        """Those of all soft materials but the first one, which is the body's own."""
        regions = []
        for i, (law, _, cells) in enumerate(soft[1:], 1):
            nodes = {row[n] for cell in cells for n in cell}
            inside = [c for _, _, others in soft for c in others if nodes.issuperset(row[n] for n in c)]
            if len(inside) != len(cells):
                raise InexpressibleError("a region that its nodes do not tell from others")
            regions.append({"name": f"part {i}", "where": {"vertices": sorted(nodes)}, "material": law})
        return regions

    def scene(self):
        """(the scene, the free components (nodes, 3), the used nodes in the order of its vertices)."""
        rigid_nodes, soft = {}, []
        for law, mixed_or_name, cells in self.domains():
            if law is None:
                rigid_nodes.setdefault(mixed_or_name, set()).update(n for cell in cells for n in cell)
            else:
                soft.append((law, mixed_or_name, cells))
        if not soft:
            raise InexpressibleError("rigid bodies alone")
        if len({len(cells[0]) for _, _, cells in soft}) > 1 or len({mixed for _, mixed, _ in soft}) > 1:
            raise InexpressibleError("elements of several kinds")
        used = sorted({node for _, _, cells in soft for cell in cells for node in cell})
        row = {node: i for i, node in enumerate(used)}
        held = {key: value for key, value in self.prescribed(rigid_nodes).items() if key[0] in row}
        cells = np.array([[row[n] for n in cell] for _, _, cells in soft for cell in cells])
        mesh = resilin.Mesh(np.array([self.positions[n] for n in used]), cells)
        element = ("Q1P0" if soft[0][1] else "Q1") if cells.shape[1] == 8 else "P1"
        body = {"name": "body", "mesh": mesh, "element": element, "material": soft[0][0], "mass": "consistent"}
        if len(soft) > 1:
            body["region"] = self.regions(soft, row)
        scene = {
            "simulation": {"kind": "static", "load_steps": 10, "gravity": [0, 0, 0]},
            "newton": {"tolerance": 1e-11, "max_iterations": 200},
            "body": [body],
            "fix": [],
            "load": [],
        }
        if "viscoelastic" in soft[0][0]:
            # Loads that are constant from the start: a creep test.
            scene["simulation"] |= {"end_time": self.end, "load_steps": 1000}
        if self.is_dynamic:
            scene["simulation"] = {
                "kind": "dynamic",
                "integrator": self.integrator,
                "time_step": self.step,
                "end_time": self.end,
                "gravity": [0, 0, 0],
            }
        groups = collections.defaultdict(list)
        for (node, component), value in held.items():
            groups[component, value].append(row[node])
        for i, ((component, value), nodes) in enumerate(sorted(groups.items())):
            displacement = [value * (c == component) for c in range(3)]
            scene["fix"].append(
                {
                    "name": f"fix {i}",
                    "where": {"vertices": sorted(nodes)},
                    "components": "xyz"[component],
                    "displacement": displacement,
                }
            )
        for load in self.loads():
            if load["kind"] == "gravity":
                scene["simulation"]["gravity"] = load["value"]
                continue
            if load["kind"] == "pressure":
                nodes = sorted({row[n] for facet in load.pop("surface") for n in facet})
                load["where"] = {"vertices": nodes}
            else:
                load["where"] = {"vertices": [row[n] for n in load["where"]["vertices"]]}
            if "viscoelastic" in soft[0][0]:
                load["time_function"] = {"table": [[0, 1], [1, 1]]}
            scene["load"].append({"name": f"load {len(scene['load'])}", **load})
        if springs := self.springs(row):
            scene["spring"] = springs
        free = np.ones((len(used), 3), dtype=bool)
        for node, component in held:
            free[row[node], component] = False
        constraints, determined = self.linear_constraints(row)
        if constraints:
            scene["constraint"] = constraints
        for vertex, component in determined:
            free[vertex, component] = False
        return scene, free


def norm_of(path):
    problem = Problem(path)
    scene, free = problem.scene()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = resilin.run(scene)
    if result.report["status"] != "done":
        raise RuntimeError(result.report["reason"])
    displacement = np.asarray(result.positions[-1]) - np.asarray(result.positions[0])
    return float(np.linalg.norm(displacement[free]))


def compare(folder, only):
    """[{name, difference or problem}] of all problems, in their order."""
    rows = []
    for name, known in json.loads((folder / "norms.json").read_text()).items():
        if only not in name:
            continue
        row = {"name": name, "norm": known["norm"], "outcome": known["outcome"]}
        try:
            row["ours"] = norm_of(folder / f"{name}.feb")
            row["difference"] = abs(row["ours"] - known["norm"]) / abs(known["norm"])
        except InexpressibleError as problem:
            row["cannot"] = str(problem)
        except Exception as problem:  # noqa: BLE001 - a problem that fails is a row like the others
            row["problem"] = str(problem).splitlines()[0]
        rows.append(row)
        print(name, row.get("difference", row.get("problem") or "cannot: " + row.get("cannot", "")), flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="TEXT", help="problems whose name contains this")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write the rows")
    arguments = parser.parse_args()
    if not os.environ.get("RESILIN_SHARED"):
        parser.error("RESILIN_SHARED: expected the folder that holds febio/, got nothing")
    rows = compare(pathlib.Path(os.environ["RESILIN_SHARED"]) / "febio", arguments.only)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))
    run = [row for row in rows if "cannot" not in row]
    print(f"{len(rows)} problems, {len(run)} expressible")
    for limit in (1e-6, 1e-4, 1e-2):
        print(f"to {limit:g}: {sum(row.get('difference', 1) <= limit for row in run)}")
    reasons = collections.Counter(row["cannot"] for row in rows if "cannot" in row)
    for reason, count in reasons.most_common():
        print(f"{count:4}  {reason}")


if __name__ == "__main__":
    main()
