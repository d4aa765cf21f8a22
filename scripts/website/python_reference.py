"""A reference of the Python package from its sources: signatures and docstrings, without importing it."""

import ast
import re

from files import ROOT

PACKAGE = ROOT / "python" / "resilin"
FURTHER = ("torch",)  # modules that are imported by name
# Chapters of the page with their modules; modules that no chapter names are in the last.
CHAPTERS = {
    "Scenes and results": ("simulation", "result", "picture", "live"),
    "Gradients and inverse design": ("gradient", "differentiated", "differentiated_batch", "rest_shape"),
    "Calibration and parameter identification": ("fit", "scene_fit"),
    "Parameter sweeps": ("sweeps", "sweep_table"),
    "Meshes, materials, energies": ("mesh", "material", "catalog", "embedding", "elastic"),
    "Threads": (),
}


def parsed(module):
    return ast.parse((PACKAGE / f"{module}.py").read_text(encoding="utf-8"))


def public_names():
    """(name, module) of what `import resilin` offers, in the order of the modules."""
    tree = parsed("__init__")
    home = homes_of_imports(tree)
    offered = next(
        [element.value for element in node.value.elts]
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
    )
    return [(name, defining(name, home[name])) for name in home if name in offered and home[name] != "_core"]


def homes_of_imports(tree):
    """Name -> the module of the package that it is imported from."""
    return {
        alias.asname or alias.name: statement.module.removeprefix("resilin.")
        for statement in tree.body
        if isinstance(statement, ast.ImportFrom) and statement.module and statement.module.startswith("resilin.")
        for alias in statement.names
    }


def defining(name, module):
    """The module that defines what another one offers."""
    tree = parsed(module)
    return module if name in definitions(tree) else defining(name, homes_of_imports(tree)[name])


def definitions(tree):
    """Name -> classes and functions of a module; of overloads the one that does it."""
    kinds = ast.ClassDef | ast.FunctionDef
    return {node.name: node for node in tree.body if isinstance(node, kinds)}


def base_classes(node, tree):
    """The classes of the package that a class is made of, itself first."""
    found = [(node, tree)]
    homes = homes_of_imports(tree)
    for base in node.bases:
        name = base.value.id if isinstance(base, ast.Subscript) else getattr(base, "id", "")
        if name in homes and (PACKAGE / f"{homes[name]}.py").is_file():
            other = parsed(homes[name])
            found += base_classes(definitions(other)[name], other)
        elif name in definitions(tree):
            found += base_classes(definitions(tree)[name], tree)
    return found


def decorators(node):
    return {ast.unparse(decorator).split("(")[0].split(".")[-1] for decorator in node.decorator_list}


def signature(node, drops_first):
    """As it is called, without annotations: docstrings say what goes in."""
    arguments = node.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults = [None] * (len(positional) - len(arguments.defaults)) + arguments.defaults
    pairs = list(zip(positional, defaults, strict=True))[1 if drops_first else 0 :]
    shown = [argument.arg + (f"={ast.unparse(default)}" if default else "") for argument, default in pairs]
    if arguments.vararg:
        shown.append("*" + arguments.vararg.arg)
    elif arguments.kwonlyargs:
        shown.append("*")
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
        shown.append(argument.arg + (f"={ast.unparse(default)}" if default else ""))
    if arguments.kwarg:
        shown.append("**" + arguments.kwarg.arg)
    return f"({', '.join(shown)})"


def docstring(node, what):
    """The docstring as reStructuredText, from NumPy's style."""
    from sphinx.ext.napoleon import Config, NumpyDocstring

    config = Config(napoleon_use_rtype=False, napoleon_custom_sections=[("Attributes", "params_style")])
    text = re.sub(r"(?=\*\*|\|)", r"\\", ast.get_docstring(node) or "")  # powers and norms are no markup
    return NumpyDocstring(text, config, what=what).lines()


def directive(kind, head, body):
    return [f".. py:{kind}:: {head}", "", *("   " + line if line else "" for line in body), ""]


def function_lines(node, drops_first=False, kind="function"):
    return directive(kind, node.name + signature(node, drops_first), docstring(node, kind))


def fields_of(node, source):
    """Fields of a dataclass, with the comments beside them."""
    for statement in node.body:
        if isinstance(statement, ast.AnnAssign) and not statement.target.id.startswith("_"):
            line = source[statement.end_lineno - 1]
            comment = line.partition("#:")[2].strip() or line.partition("  # ")[2].strip()
            yield directive("attribute", statement.target.id, [comment.replace("*", r"\*")])


def class_lines(node, module, tree):
    members, seen = [], set()
    initial = None
    for owner, _ in base_classes(node, tree):
        for member in owner.body:
            if not isinstance(member, ast.FunctionDef) or "overload" in decorators(member):
                continue
            if member.name == "__init__":
                initial = initial or member
            is_new = member.name not in seen and not member.name.startswith("_")
            seen.add(member.name)
            if not is_new or "setter" in decorators(member):
                continue
            if decorators(member) & {"property", "cached_property"}:
                members += directive("property", member.name, docstring(member, "property"))
            else:
                special = decorators(member) & {"staticmethod", "classmethod"}
                kind = special.pop() if special else "method"
                members += function_lines(member, kind != "staticmethod", kind)
    source = (PACKAGE / f"{module}.py").read_text(encoding="utf-8").splitlines()
    fields = [line for field in fields_of(node, source) for line in field]
    is_made_here = initial is not None and "core" not in [argument.arg for argument in initial.args.args]
    head = node.name + (signature(initial, True) if is_made_here else "")
    return directive("class", head, [*docstring(node, "class"), "", *fields, *members])


def entry_lines(node, module, tree):
    return class_lines(node, module, tree) if isinstance(node, ast.ClassDef) else function_lines(node)


def by_chapter(names):
    """Chapter -> its (name, module), functions before classes."""
    home = {module: chapter for chapter, modules in CHAPTERS.items() for module in modules}
    chapters = {chapter: [] for chapter in CHAPTERS}
    for name, module in names:
        chapters[home.get(module, list(CHAPTERS)[-1])].append((name, module))

    def place(chapter, name, module):
        order = CHAPTERS[chapter].index(module) if module in CHAPTERS[chapter] else len(CHAPTERS[chapter])
        return (not name[0].islower(), order)

    return {chapter: sorted(found, key=lambda entry: place(chapter, *entry)) for chapter, found in chapters.items()}


def overview(chapters):
    """A table of all names with the first line of their docstrings."""
    lines = [".. list-table::", "   :widths: 30 70", ""]
    for chapter, names in chapters.items():
        lines += [f"   * - **{chapter}**", "     -"]
        for name, module in names:
            kind = "func" if name[0].islower() else "class"
            first = (ast.get_docstring(definitions(parsed(module))[name]) or "").split("\n\n")[0].replace("\n", " ")
            lines += [f"   * - :py:{kind}:`~resilin.{name}`", f"     - {first}"]
    return [*lines, ""]


def underlined(title, mark):
    return [title, mark * len(title), ""]


def page():
    """The page in reStructuredText."""
    lines = [*underlined("Python reference", "="), "Functions and classes of ``import resilin``. Units are SI;"]
    lines += ["``N`` counts nodes, ``M`` cells, ``T`` frames, ``d`` is the dimension, 2 or 3."]
    lines += [":doc:`The guide </docs/python>` shows them at work.", "", ".. py:module:: resilin", ""]
    chapters = by_chapter(public_names())
    lines += overview(chapters)
    for chapter, names in chapters.items():
        lines += underlined(chapter, "-")
        for name, module in names:
            tree = parsed(module)
            lines += [*underlined(name, "~"), *entry_lines(definitions(tree)[name], module, tree)]
    for module in FURTHER:
        tree = parsed(module)
        head = f"resilin.{module}"
        lines += [*underlined(head, "-"), f".. py:module:: {head}", "", ast.get_docstring(tree), ""]
        for name, node in definitions(tree).items():
            if not name.startswith("_"):
                lines += entry_lines(node, module, tree)
    return "\n".join(lines) + "\n"
