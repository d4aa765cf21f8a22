"""A file of FEBio: nodes, sets, cells, curves, steps and boundary conditions."""

import xml.etree.ElementTree as ElementTree

from curves import Curve
from materials import InexpressibleError, law_of, number, vector

REFUSED = ("Initial", "MeshAdaptor")  # sections
ROTATIONS = ("u", "v", "w")


class Phase:
    """A step, with the elements of its own and those that belong to all steps."""

    def __init__(self, control, start):
        self.is_dynamic = control.findtext("analysis", "STATIC").strip().upper() == "DYNAMIC"
        self.rhoi = control.findtext("solver/rhoi")
        self.num_steps = int(control.findtext("time_steps"))
        self.step = float(control.findtext("step_size"))
        self.start = start
        self.end = start + self.num_steps * self.step
        if self.is_dynamic and "explicit" in control.find("solver").get("type", ""):
            raise InexpressibleError("explicit dynamics")
        # The generalised-alpha method of spectral radius 1 is the implicit midpoint rule. With smaller radii it damps
        # the highest frequencies, as TR-BDF2 does. -2 stands for Newmark's rule.
        self.integrator = {"1": "midpoint", "-2": "newmark"}.get(self.rhoi, "tr_bdf2")

    @property
    def duration(self):
        return self.num_steps * self.step

    @property
    def times(self):
        return [self.start + i * self.step for i in range(self.num_steps + 1)]


class Block:
    """A domain: a material and its cells."""

    def __init__(self, name, material, cells, has_three_fields, law):
        self.name, self.material, self.cells = name, material, cells
        self.has_three_fields, self.law = has_three_fields, law

    @property
    def nodes(self):
        return sorted({node for cell in self.cells for node in cell})

    def connected_parts(self):
        """Blocks of cells that share nodes."""
        groups = []  # (nodes, cells)
        for cell in self.cells:
            touching = [group for group in groups if not group[0].isdisjoint(cell)]
            groups = [group for group in groups if group not in touching]
            groups.append((set(cell).union(*(g[0] for g in touching)), [c for g in touching for c in g[1]] + [cell]))
        if len(groups) == 1:
            return [self]
        if "fibres" in str(self.law):
            raise InexpressibleError("fibres in parts that are not connected")
        return [Block(self.name, self.material, cells, self.has_three_fields, self.law) for _, cells in groups]


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
        self.node_sets = {s.get("name"): self.indices(s.text) for s in self.root.findall("./Mesh/NodeSet")}
        self.curves = {}
        self.refuse_what_is_missing()
        self.phases = self.read_phases()
        self.materials = {m.get("name"): m for m in self.root.findall("./Material/material")}
        self.blocks = self.read_blocks()

    def indices(self, text):
        return [self.ids[i.strip()] for i in (text or "").split(",") if i.strip()]

    def refuse_what_is_missing(self):
        for section in (*(f"./{s}" for s in REFUSED), *(f"./Step/step/{s}" for s in REFUSED)):
            for found in self.root.findall(section):
                if len(found):
                    kinds = sorted({str(e.get("type") or e.tag) for e in found})
                    raise InexpressibleError(f"{found.tag}: {', '.join(kinds)}")
        for kind in ("ShellDomain", "BeamDomain"):
            for domain in self.root.findall(f"./MeshDomains/{kind}"):
                material = self.root.find(f"./Material/material[@name='{domain.get('mat')}']")
                if material is None or material.get("type") != "rigid body":
                    raise InexpressibleError(kind)
        for constraint in self.root.findall("./Constraints/constraint"):
            if constraint.get("type") != "rigid_wall":
                raise InexpressibleError(f"Constraints: {constraint.get('type')}")

    def read_phases(self):
        steps = self.root.findall("./Step/step")
        if not steps:
            return [Phase(self.root.find("Control"), 0)]
        phases = []
        for step in steps:
            phases.append(Phase(step.find("Control"), phases[-1].end if phases else 0))
        return phases

    def elements(self, section, phase=None):
        """The elements of a section: those of all steps, then those of one phase."""
        found = self.root.findall(f"./{section}/*")
        steps = self.root.findall("./Step/step")
        if steps:
            index = 0 if phase is None else self.phases.index(phase)
            found += steps[index].findall(f"./{section}/*")
        return found

    def curve(self, name):
        if name not in self.curves:
            controller = self.root.find(f"./LoadData/load_controller[@id='{name}']")
            if controller is None:
                raise InexpressibleError("load curve that is missing")
            self.curves[name] = Curve(controller)
        return self.curves[name]

    def function(self, element):
        """The value of an element as a function of time."""
        if element.get("type") not in (None, "const"):
            raise InexpressibleError(f"{element.tag} of type {element.get('type')}")
        value = float(element.text)
        if element.get("lc") is None or value == 0:
            return lambda _: value
        curve = self.curve(element.get("lc"))
        return lambda t: value * curve(t)

    def read_blocks(self):
        blocks = {e.get("name"): e for e in self.root.findall("./Mesh/Elements")}
        found = []
        for domain in self.root.findall("./MeshDomains/SolidDomain"):
            material, block = self.materials[domain.get("mat")], blocks[domain.get("name")]
            if block.get("type") not in ("hex8", "tet4"):
                raise InexpressibleError(f"elements {block.get('type')}")
            kind = domain.get("type")
            if kind not in (None, "elastic-solid", "three-field-solid"):
                raise InexpressibleError(f"domain {kind}")
            cells = [self.indices(cell.text) for cell in block]
            law, has_three_fields = None, False
            if material.get("type") != "rigid body":
                law, is_mixed = law_of(material, cells, self)
                law["density"] = number(material, "density", 1)
                has_three_fields = (is_mixed if kind is None else "three" in kind) and block.get("type") == "hex8"
            found.append(Block(domain.get("name"), material.get("name"), cells, has_three_fields, law))
        return found

    @property
    def soft(self):
        return [block for block in self.blocks if block.law]

    def rigid_cells(self, name):
        return [cell for block in self.blocks if not block.law and block.material == name for cell in block.cells]

    def nodes_of(self, name):
        if name is None:
            raise InexpressibleError("a boundary condition without node_set")
        if name.startswith(("@surface:", "@edge:")):
            kind, name = name[1:].split(":", 1)
            return sorted({node for facet in self.surface(name, kind.capitalize()) for node in facet})
        if name not in self.node_sets:
            raise InexpressibleError(f"node set {name}")
        return self.node_sets[name]

    def surface(self, name, kind="Surface"):
        for surface in self.root.findall(f"./Mesh/{kind}"):
            if surface.get("name") == name:
                return [self.indices(facet.text) for facet in surface]
        raise InexpressibleError(f"surface {name}")

    def surface_pair(self, name):
        pair = self.root.find(f"./Mesh/SurfacePair[@name='{name}']")
        return [self.surface(pair.findtext(side).strip()) for side in ("primary", "secondary")]


class RigidMotion:
    """The degrees of freedom of a rigid body that are fixed or prescribed, as functions of time."""

    def __init__(self, problem, name, phase):
        material = problem.materials[name]
        self.name = name
        self.moves = {}  # x, y, z, u, v, w: function of time
        self.forces = []
        for element in problem.elements("Rigid", phase):
            kind = element.get("type")
            if element.findtext("rb") != name or kind.startswith("initial_"):
                continue
            if kind == "rigid_fixed":
                for tag in ("x", "y", "z", *ROTATIONS):
                    if element.findtext(f"R{tag}_dof", "0") == "1":
                        self.moves[tag] = lambda _: 0.0
            elif kind in ("rigid_displacement", "rigid_rotation"):
                tag = element.findtext("dof").strip()[-1].lower()
                self.moves[tag] = problem.function(element.find("value"))
            elif kind == "rigid_rotation_vector":
                for tag, letter in zip(ROTATIONS, "xyz", strict=True):
                    self.moves[tag] = problem.function(element.find(f"v{letter}"))
            elif kind == "rigid_force" and element.findtext("load_type", "LOAD") in ("LOAD", "0"):
                component = "xyz".index(element.findtext("dof").strip()[-1].lower())
                self.forces.append((component, problem.function(element.find("value"))))
            else:
                raise InexpressibleError(f"rigid bodies with {kind}")
        centre = material.find("center_of_mass")
        self.cells = problem.rigid_cells(name)
        self.centre = None if centre is None else vector(centre.text)
        self.density = number(material, "density", 1)

    @property
    def is_known(self):
        return len(self.moves) == 6

    @property
    def turns(self):
        return any(tag not in self.moves for tag in ROTATIONS) or any(
            self.moves[tag](t) != 0 for tag in ROTATIONS for t in (0.3, 0.7, 1.0)
        )

    def at(self, t):
        """(translation, rotation vector) of a motion that is known."""
        return [self.moves[c](t) for c in "xyz"], [self.moves[c](t) for c in ROTATIONS]
