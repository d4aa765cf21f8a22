"""Materials of FEBio's files as materials of a scene."""

import numpy as np


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
    if found.get("type") not in (None, "const"):
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


def directions(material, cells, problem):
    """Directions of fibres for each cell; one for all if they are equal."""
    fiber = material.find("fiber")
    kind = None if fiber is None else fiber.get("type")
    if kind == "vector":
        return vector((fiber.findtext("vector") or fiber.text).strip())
    if kind == "angles":
        theta, phi = (np.radians(number(fiber, name, 0)) for name in ("theta", "phi"))
        return [float(np.cos(theta) * np.sin(phi)), float(np.sin(theta) * np.sin(phi)), float(np.cos(phi))]
    positions = np.array(problem.positions)[np.array(cells)]
    if kind == "local":
        first, second = (int(i) - 1 for i in fiber.findtext("local").split(","))
        return (positions[:, second] - positions[:, first]).tolist()
    if kind == "spherical":
        if vector(fiber.findtext("vector", "1,0,0")) != [1, 0, 0]:
            raise InexpressibleError("spherical fibers that are not radial")
        return (positions.mean(axis=1) - vector(fiber.findtext("center", "0,0,0"))).tolist()
    if kind == "user":
        data = problem.root.find("./MeshData/ElementData[@type='fiber']")
        rows = {int(element.get("lid")): vector((element.findtext("a") or element.text).strip()) for element in data}
        return [rows[i + 1] for i in range(len(cells))]
    raise InexpressibleError(f"fiber of type {kind}")


def toe_linear_fibres(material, fibres, stretch_name):
    c3, c4, c5 = (number(material, name) for name in ("c3", "c4", "c5"))
    stretch = number(material, stretch_name)
    if c3 == 0:  # FEBio then makes the slope continuous
        c3 = c5 / c4 * np.exp(-c4 * (stretch - 1))
    return {
        "law": "toe_linear_fibre",
        "fibre_modulus": c3,
        "fibre_stiffening": c4,
        "straight_modulus": c5,
        "straight_stretch": stretch,
        "fibres": [fibres],
    }


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
    return {"law": "ogden", **constants}


def series(material):
    """Shares g_i of the long-term moduli beside g0 = 1."""
    if number(material, "g0", 1) != 1:
        raise InexpressibleError("viscoelastic with g0 other than 1")
    branches = [(number(material, f"g{i}", 0), number(material, f"t{i}", 1)) for i in range(1, 7)]
    branches = [branch for branch in branches if branch[0] != 0]
    return {"g": [g for g, _ in branches], "tau": [tau for _, tau in branches], "moduli": "long_term"}


def uncoupled(material, cells, problem):
    """Parts of a sum that have no volumetric energy."""
    kind = material.get("type")

    def get(name, default=None):
        return number(material, name, default)

    if kind == "Mooney-Rivlin":
        return [{"law": "mooney_rivlin", "c10": get("c1"), "c01": get("c2", 0)}]
    if kind == "Yeoh":
        if any(get(f"c{i}", 0) != 0 for i in (4, 5, 6)):
            raise InexpressibleError("Yeoh with more than three terms")
        return [{"law": "yeoh", "c10": get("c1"), "c20": get("c2", 0), "c30": get("c3", 0)}]
    if kind == "Veronda-Westmann":
        return [{"law": "veronda_westmann", "c1": get("c1"), "c2": get("c2")}]
    if kind == "Ogden":
        return [ogden(material)]
    if kind in ("trans iso Mooney-Rivlin", "trans iso Veronda-Westmann"):
        if number(material, "active_contraction/ascl", 0) != 0:
            raise InexpressibleError("active contraction")
        fibres = toe_linear_fibres(material, directions(material, cells, problem), "lam_max")
        if kind == "trans iso Veronda-Westmann":
            return [{"law": "veronda_westmann", "c1": get("c1"), "c2": get("c2")}, fibres]
        return [{"law": "mooney_rivlin", "c10": get("c1"), "c01": get("c2", 0)}, fibres]
    if kind == "uncoupled fiber-exp-linear":
        return [toe_linear_fibres(material, directions(material, cells, problem), "lambda")]
    raise InexpressibleError(f"material {kind}")


def law_of(material, cells, problem):
    """(material of a scene, whether FEBio's hexahedra have three fields)."""
    kind = material.get("type")

    def get(name, default=None):
        return number(material, name, default)

    if kind == "neo-Hookean":
        return {"law": "neo_hookean", "youngs_modulus": get("E"), "poissons_ratio": get("v")}, False
    if kind in ("isotropic elastic", "St.Venant-Kirchhoff"):
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
        law, _ = law_of(material.find("elastic"), cells, problem)
        return {**law, "viscoelastic": {**series(material), "formulation": "whole"}}, False
    if kind == "solid mixture":
        parts = [law_of(solid, cells, problem)[0] for solid in material.findall("solid")]
        return {"sum": parts}, False
    if material.findtext("pressure_model", "default") not in ("default", "0"):
        raise InexpressibleError("another pressure_model")
    if kind == "uncoupled viscoelastic":
        parts = uncoupled(material.find("elastic"), cells, problem)
        if len(parts) > 1 or parts[0]["law"] != "ogden":
            raise InexpressibleError(f"uncoupled viscoelastic {material.find('elastic').get('type')}")
        # kappa/2 (J - 1)^2 in place of kappa/2 (ln J)^2: equal to first order in J - 1, which is small here.
        law = {**parts[0], "bulk_modulus": get("k")}
        return {**law, "viscoelastic": {**series(material), "formulation": "iso"}}, True
    if kind == "uncoupled solid mixture":
        parts = [part for solid in material.findall("solid") for part in uncoupled(solid, cells, problem)]
        return {"sum": [*parts, volumetric(get("k"))]}, True
    return {"sum": [*uncoupled(material, cells, problem), volumetric(get("k"))]}, True
