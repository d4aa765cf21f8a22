"""Arguments that make a material of any law of the catalogue."""

import resilin

LAWS = sorted(resilin.laws())


def poissons_ratio_of(law, wished):
    only = resilin.laws()[law].only_poissons_ratio
    return wished if only is None else only


def beside_young_and_poisson(law, modulus):
    """Fibres, and the constants that a law cannot do without; `modulus` is the size of those in Pa."""
    info = resilin.laws()[law]
    needed = (constant for constant in info.constants if constant.is_free and constant.fallback is None)
    arguments = {constant.name: 0.4 * modulus if constant.unit == "Pa" else 0.7 for constant in needed}
    if info.max_fibres > 0:
        arguments["fibres"] = [[0.8, 0.6, 0.0], [0.6, -0.64, 0.48]][: info.max_fibres]
    return arguments


def material_of(law, youngs_modulus=1e5, poissons_ratio=0.3):
    arguments = beside_young_and_poisson(law, youngs_modulus)
    poissons_ratio = poissons_ratio_of(law, poissons_ratio)
    return resilin.Material(law, youngs_modulus=youngs_modulus, poissons_ratio=poissons_ratio, **arguments)
