"""Checks the direction between rooms: who may include and link whom, that no Python module imports in a circle, and
that no header of the library brings a heavy one into every file.

The rule itself stands in CONTRIBUTING.md, in the block marked `direction`, as lines of `A <- B <- C` where B may use
A and C both; a group in braces stands for each of its members, parts are separated by semicolons.
"""

import itertools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"](?:resilin/)?([a-z_]+)/', re.MULTILINE)
MODULE = re.compile(r"resilin_module\(\s*([a-z_]+)(.*?)\)", re.DOTALL)
LINKED = re.compile(r"\bresilin(?:::|_)([a-z_]+)")
IMPORT = re.compile(r"^\s*(?:from resilin\.(\w+) import|import resilin\.(\w+)|from resilin import (.+))", re.MULTILINE)
# Seconds in each file that sees them, or thousands of templates; sources that need one include it.
HEAVY = re.compile(
    r"^\s*#\s*include\s*<("
    r"Eigen/(?!Core)\w+|nlohmann/json\.hpp|CLI/.*|spdlog/.*|fmt/.*|toml\+\+/.*|boost/.*|regex|iostream|ranges)>",
    re.MULTILINE,
)
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
    if path.name == "CMakeLists.txt" and "resilin_module(" not in text:
        for match in LINKED.finditer(text):
            yield text.count("\n", 0, match.start()) + 1, match.group(1)
    elif path.name == "CMakeLists.txt":
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
        if used in allowed and used not in allowed[module]
    ]


def heavy_includes(path, text):
    """A header of the library includes no heavy one; report.hpp is for the two sources that write reports."""
    if path.suffix != ".hpp" or path.parts[0] != "src" or path.as_posix() == "src/resilin/results/report.hpp":
        return []
    return [
        f"{path}:{text.count(chr(10), 0, match.start(1)) + 1}: <{match.group(1)}> in a header costs time in every file "
        "that sees it; include it in the sources that need it"
        for match in HEAVY.finditer(text)
    ]


def room_files():
    """(path, room) for all sources: a folder of src/resilin is a room, and so is each program, Python and the tests."""
    folders = {
        "src/resilin/*": None,
        "apps/*": None,
        "benchmarks": "benchmarks",
        "python/src": "python",
        "tests": "tests",
    }
    for pattern, room in folders.items():
        for folder in sorted(ROOT.glob(pattern)):
            # Headers straight in src/resilin, such as version.hpp, belong to everyone.
            for path in sorted(folder.rglob("*")) if folder.is_dir() else []:
                if is_checked(path):
                    yield path, room or folder.name


def circles(imports):
    """The modules that import themselves through others, as "a -> b -> a"; `imports`: module -> modules."""
    found = set()

    def follow(path):
        for used in sorted(imports.get(path[-1], ())):
            if used in path:
                circle = path[path.index(used) :]
                first = circle.index(min(circle))
                found.add(" -> ".join([*circle[first:], *circle[:first], circle[first]]))
            else:
                follow([*path, used])

    for module in sorted(imports):
        follow([module])
    return sorted(found)


def imports_of_text(text, modules):
    """Modules of the package that a text imports, wherever in it."""
    words = [word for groups in IMPORT.findall(text) for group in groups for word in re.findall(r"\w+", group)]
    return {word for word in words if word in modules}


def python_problems():
    files = {path.stem: path for path in sorted((ROOT / "python" / "resilin").glob("*.py"))}
    imports = {name: imports_of_text(path.read_text(encoding="utf-8"), files) for name, path in files.items()}
    return [f"python/resilin: {circle}; one of them must do without" for circle in circles(imports)]


def is_checked(path):
    return path.suffix in SUFFIXES or path.name == "CMakeLists.txt"


def find_problems():
    allowed = read_rule()
    problems = [
        problem
        for path, module in room_files()
        for problem in problems_of_file(path.relative_to(ROOT), module, path.read_text(encoding="utf-8"), allowed)
    ]
    heavy = [
        problem
        for path, _ in room_files()
        for problem in heavy_includes(path.relative_to(ROOT), path.read_text(encoding="utf-8"))
    ]
    return problems + heavy + python_problems()


def find_faults_of_this_check():
    """The check itself: violations are found, allowed uses are not."""
    allowed = read_rule()
    cases = [  # file, module, text, number of problems
        ("a.hpp", "material", '#include "resilin/energy/energy.hpp"\n', 1),
        ("a.cpp", "linear", "#pragma once\n  # include <resilin/mesh/mesh.hpp>\n", 1),
        ("a.cpp", "io", '#include "resilin/scene/scene.hpp"\n#include "resilin/world/world.hpp"\n', 2),
        ("a.cpp", "optimize", '#include "resilin/linear/block_matrix.hpp"\n#include "resilin/core/types.hpp"\n', 0),
        ("a.cpp", "cli", '#include "resilin/core/types.hpp"\n#include "resilin/scene/scene.hpp"\n', 0),
        ("a.cpp", "viewer", '#include "bench/live.hpp"\n#include "benchmarks/live.hpp"\n', 1),
        ("a.cpp", "benchmarks", '#include "viewer/page_client.hpp"\n#include <gtest/gtest.h>\n', 0),
        ("CMakeLists.txt", "viewer", "target_link_libraries(resilin_viewer PUBLIC resilin::live resilin_cli)", 1),
        ("a.cpp", "elsewhere", "", 1),
        ("CMakeLists.txt", "core", "resilin_module(core SOURCES a.cpp DEPENDS mesh LINK x)", 1),
        ("CMakeLists.txt", "energy", "resilin_module(energy\n SOURCES a.cpp\n DEPENDS mesh linear\n LINK x)", 0),
    ]
    faults = []
    for name, module, text, expected in cases:
        found = problems_of_file(pathlib.Path(name), module, text, allowed)
        if len(found) != expected:
            faults.append(f"{module} with {text!r}: expected {expected} problems, got {found}")
    heavy = "#include <Eigen/Dense>\n#include <Eigen/Core>\n#include <fmt/format.h>\n#include <nlohmann/json_fwd.hpp>\n"
    for name, expected in {"src/resilin/core/a.hpp": 2, "src/resilin/core/a.cpp": 0, "apps/cli/a.hpp": 0}.items():
        if len(heavy_includes(pathlib.Path(name), heavy)) != expected:
            faults.append(f"heavy headers in {name}: expected {expected} problems")
    if circles({"a": {"b"}, "b": {"c"}, "c": {"b"}}) != ["b -> c -> b"]:
        faults.append("a circle of imports is not seen")
    if imports_of_text("from resilin.a import x\n    from resilin import b, c\n", {"a", "c"}) != {"a", "c"}:
        faults.append("imports are not seen")
    return faults


if __name__ == "__main__":
    found = find_problems()
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
