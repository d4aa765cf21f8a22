"""A listing of the headers for those who build on the library: declarations with their comments, without bodies."""

import re

from files import ROOT, repository_files

SOURCES = ROOT / "src" / "resilin"
NAME = re.compile(
    r"\b(?:struct|class|enum class|concept|using)\s+([A-Za-z_]\w*)|([A-Za-z_]\w*|operator\S+)\s*\(|(\w+)\s*="
)
TYPE = re.compile(r"\b(?:struct|class|enum|union|namespace|concept)\s+\w")
TEMPLATE = re.compile(r"template\s*<[^;{]*?>\s*\n")
COMMENT = re.compile(r"//[^\n]*")
INITIALIZERS = re.compile(r"(\)(?:\s*(?:const|noexcept))*)\s*:\s[^:;{}][^;]*$")  # initializers of a constructor
SKIPPED = re.compile(r"#pragma once|#include|namespace [\w:]*\s*\{$|\}\s*// namespace|class \w+;$|struct \w+;$")


def without_bodies(text):
    """Functions end where their body would begin; classes and enums keep theirs."""
    shown, i = "", 0
    while i < len(text):
        if text.startswith("//", i):
            end = text.find("\n", i)
            end = len(text) if end < 0 else end
            shown += text[i:end]
            i = end
        elif text[i] == "{" and is_body(text, i):
            i = end_of_braces(text, i)
            shown = INITIALIZERS.sub(r"\1", shown.rstrip()) + ("" if text.startswith(";", i) else ";")
        else:
            shown += text[i]
            i += 1
    return shown


def is_body(text, i):
    """Whether the brace at i opens the body of a function."""
    before = text[max(0, i - 800) : i]
    cut = max(before.rfind(mark) for mark in ";{}")
    head = TEMPLATE.sub("", COMMENT.sub("", before[cut + 1 :]))
    return bool(re.search(r"\)[^=]*$", head)) and not TYPE.search(head)


def end_of_braces(text, i):
    depth = 0
    for match in re.finditer(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'|//[^\n]*|[{}]', text[i:]):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
            if depth == 0:
                return i + match.end()
    return len(text)


def without_private_parts(text):
    """Classes end where `private:` begins; details of the house are no part of a listing."""
    text = re.sub(r"\n private:\n.*?(?=\n\};|\n public:)", "", text, flags=re.DOTALL)
    text = re.sub(r"^namespace detail \{.*?^\}.*?$", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"^namespace \{.*?^\}.*?$", "", text, flags=re.DOTALL | re.MULTILINE)


def blocks(text):
    """Runs of lines that belong together: a comment and what it describes."""
    block, depth = [], 0
    for line in text.splitlines():
        code = re.sub(r"//.*", "", line)
        if depth == 0 and (not line.strip() or SKIPPED.match(line.strip())):
            if block:
                yield "\n".join(block)
            block = []
            continue
        if depth == 0 and line.startswith("///") and block and not block[-1].startswith("//"):
            yield "\n".join(block)
            block = []
        block.append(line)
        depth += code.count("{") + code.count("(") - code.count("}") - code.count(")")
    if block:
        yield "\n".join(block)


def names_in(block):
    """Names that a block declares, in its order."""
    names, depth = [], 0
    code = TEMPLATE.sub("", COMMENT.sub("", block))
    for line in code.splitlines():
        if depth == 0 and line[:1] not in (" ", "}", "#", "") and (match := NAME.search(line)):
            names.append(match[1] or match[2] or match[3])
        depth += line.count("{") + line.count("(") - line.count("}") - line.count(")")
    return names


def declarations(text):
    """(names, text) of what a header declares, in its order."""
    found = [(names_in(block), block) for block in blocks(without_bodies(without_private_parts(text)))]
    return [(names, block) for names, block in found if names and not names[0].isupper()]  # macros


def module_page(module, headers, code_block):
    parts = [f"---\ntocdepth: 2\n---\n# C++: {module}\n"]
    for header in headers:
        text = header.read_text(encoding="utf-8")
        found = declarations(text)
        if not found:
            continue
        parts.append(f"## {header.relative_to(SOURCES / module).as_posix()}\n")
        names = dict.fromkeys(name for names, _ in found for name in names)
        include = f"#include <{header.relative_to(SOURCES.parent).as_posix()}>"
        parts.append(f"`{include}`: " + ", ".join(f"`{name}`" for name in names) + "\n")
        parts.append(code_block("\n\n".join(block for _, block in found), "cpp"))
    return "\n".join(parts)


def pages(code_block, modules=None):
    """(name, text) of a page for each module, in the order of the sources, and of one that leads to them."""
    order = re.findall(r"add_subdirectory\((\w+)\)", (SOURCES / "CMakeLists.txt").read_text(encoding="utf-8"))
    by_module = {module: [] for module in order if modules is None or module in modules}
    for header in repository_files(".hpp"):
        if SOURCES in header.parents and header.relative_to(SOURCES).parts[0] in by_module:
            by_module[header.relative_to(SOURCES).parts[0]].append(header)
    toctree = "\n".join(by_module)
    yield (
        "index",
        "# C++ reference\n\nWhat the headers declare, module by module, with the comments that stand there. A program "
        "links `resilin::resilin`, or a module by its name ([from C++](../../index.md#from-c)); "
        "[how the modules use each other](../../CONTRIBUTING.md#where-things-live).\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{toctree}\n```\n",
    )
    for module, headers in by_module.items():
        yield module, module_page(module, headers, code_block)
