"""Checks the direction between modules: who may include and link whom.

The rule itself stands in CONTRIBUTING.md, in the block marked `direction`, as lines of `A <- B <- C` where B may use
A and C both; a group in braces stands for each of its members, parts are separated by semicolons.
"""

import itertools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]resilin/([a-z_]+)/', re.MULTILINE)
MODULE = re.compile(r"resilin_module\(\s*([a-z_]+)(.*?)\)", re.DOTALL)
SUFFIXES = {".hpp", ".cpp", ".h", ".inl", ".cu", ".cuh"}


def read_rule():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    return parse_rule(re.search(r"```direction\n(.*?)```", text, re.DOTALL).group(1))


def parse_rule(text):
    """Module -> all modules that it may use, itself included."""
    below = {}
    for chain in re.split(r"[;\n]", text):
        groups = [re.findall(r"[a-z_]+", group) for group in chain.split("<-")]
        for lower, upper in itertools.pairwise(groups):
            for module in upper:
                below.setdefault(module, set()).update(lower)
            for module in lower:
                below.setdefault(module, set())
    return {module: reachable(module, below) for module in below}


def reachable(module, below):
    seen, queue = {module}, [module]
    while queue:
        for lower in below[queue.pop()] - seen:
            seen.add(lower)
            queue.append(lower)
    return seen


def uses_in_text(path, text):
    """(line, used module) for each include of another module, or each DEPENDS of a CMakeLists.txt."""
    if path.name == "CMakeLists.txt":
        for match in MODULE.finditer(text):
            words = match.group(2).split()
            depends = words[words.index("DEPENDS") + 1 :] if "DEPENDS" in words else []
            line = text.count("\n", 0, match.start()) + 1
            for word in depends:
                if word.isupper():
                    break
                yield line, word
    else:
        for match in INCLUDE.finditer(text):
            yield text.count("\n", 0, match.start(1)) + 1, match.group(1)


def problems_of_file(path, module, text, allowed):
    if module not in allowed:
        return [f"{path}: module {module} has no place in the direction block of CONTRIBUTING.md; give it one"]
    return [
        f"{path}:{line}: {module} may use {', '.join(sorted(allowed[module] - {module}))}, not {used}; "
        "move the shared part down or the using part up"
        for line, used in uses_in_text(path, text)
        if used not in allowed[module]
    ]


def module_files():
    """(path, module) for all library sources; everything in apps/ belongs to `apps`."""
    for path in sorted((ROOT / "src" / "resilin").rglob("*")):
        parts = path.relative_to(ROOT / "src" / "resilin").parts
        # What lies straight in src/resilin, such as version.hpp, belongs to everyone.
        if len(parts) > 1 and is_checked(path):
            yield path, parts[0]
    for path in sorted((ROOT / "apps").rglob("*")):
        if is_checked(path):
            yield path, "apps"


def is_checked(path):
    return path.suffix in SUFFIXES or path.name == "CMakeLists.txt"


def find_problems():
    allowed = read_rule()
    return [
        problem
        for path, module in module_files()
        for problem in problems_of_file(path.relative_to(ROOT), module, path.read_text(encoding="utf-8"), allowed)
    ]


def find_faults_of_this_check():
    """The check itself: violations are found, allowed uses are not."""
    allowed = read_rule()
    cases = [  # file, module, text, number of problems
        ("a.hpp", "material", '#include "resilin/energy/energy.hpp"\n', 1),
        ("a.cpp", "linear", "#pragma once\n  # include <resilin/mesh/mesh.hpp>\n", 1),
        ("a.cpp", "io", '#include "resilin/scene/scene.hpp"\n#include "resilin/simulation/world.hpp"\n', 2),
        ("a.cpp", "optimize", '#include "resilin/linear/block_matrix.hpp"\n#include "resilin/core/types.hpp"\n', 0),
        ("a.cpp", "apps", '#include "resilin/core/types.hpp"\n#include "resilin/scene/scene.hpp"\n', 0),
        ("a.cpp", "elsewhere", "", 1),
        ("CMakeLists.txt", "core", "resilin_module(core SOURCES a.cpp DEPENDS mesh LINK x)", 1),
        ("CMakeLists.txt", "energy", "resilin_module(energy\n SOURCES a.cpp\n DEPENDS mesh linear\n LINK x)", 0),
    ]
    faults = []
    for name, module, text, expected in cases:
        found = problems_of_file(pathlib.Path(name), module, text, allowed)
        if len(found) != expected:
            faults.append(f"{module} with {text!r}: expected {expected} problems, got {found}")
    return faults


if __name__ == "__main__":
    found = find_problems()
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
