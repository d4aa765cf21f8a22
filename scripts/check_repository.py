"""House rules that a machine can check; each problem is one line with its place."""

import os
import pathlib
import re
import sys

from files import ROOT, relative, repository_files

MAX_LINES = 800  # a file is as long as its idea; beyond this it holds two
MAX_BYTES = 2_500_000
CODE = (".cpp", ".hpp", ".py", ".sh", ".cmake", "CMakeLists.txt", ".toml", ".yaml", ".ts", "/run", "/test")
COUNTED = (".cpp", ".hpp", ".py", ".sh", ".ts")

# Written with a bracket in each word so that this file does not find itself.
OPEN_END = re.compile(r"T[O]DO|F[I]XME|X[X]X|H[A]CK|not imple[m]ented")
MACHINE_PATH = re.compile(r"""(^|[^A-Za-z0-9_.])/(w[o]rk|f[a]rm)/|[\s"(=]/(r[o]ot|h[o]me)/""")
REGISTRY = re.compile(r"https?://[a-z0-9.-]*(p[y]pi|n[p]mjs|d[e]bian|cra[t]es)[a-z0-9.-]*/")
SKIPPED_TEST = re.compile(r"D[I]SABLED_|GTEST_S[K]IP\(\)(?! <<)|pytest\.mark\.(s[k]ip|x[f]ail)")
# Tests run side by side: each has a folder of its own, from one helper.
SHARED_FOLDER = re.compile(r"Temp[D]ir\(|temp_directory_[p]ath|mk[d]temp|[t]mpnam|gettemp[d]ir|[\"']/t[m]p/")
HOME_OF_FOLDERS = "tests/support/temporary_folder.cpp"
NAMESPACE = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;{]*)? \{", re.MULTILINE)
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)]*)?\)")

EXECUTABLES = ("run", "test", ".ci/run")


def text_of(path):
    """The text of a file, or None for a binary one."""
    data = path.read_bytes()
    if b"\0" in data:
        return None
    return data.decode("utf-8", errors="replace")


def is_test(name):
    return name.startswith(("tests/", "python/tests/"))


def problems_of_text(name, text):
    """Rules that look at the text of the file `name`, a path relative to the repository."""
    problems = []
    is_code = ("/" + name).endswith(CODE)
    for number, line in enumerate(text.splitlines(), 1):
        if is_code and OPEN_END.search(line):
            problems.append(f"{name}:{number}: an open end; finish it or open an issue")
        if MACHINE_PATH.search(line) or REGISTRY.search(line):
            problems.append(f"{name}:{number}: a path or host that other machines do not have")
        if name.startswith("tests/") and SKIPPED_TEST.search(line):
            problems.append(f"{name}:{number}: a test that is left out without a reason; mend it or remove it")
        if is_test(name) and name != HOME_OF_FOLDERS and SHARED_FOLDER.search(line):
            problems.append(
                f"{name}:{number}: a folder that other tests may use, too; take a TemporaryFolder or tmp_path"
            )
    lines = text.count("\n")
    if ("/" + name).endswith(COUNTED) and lines > MAX_LINES:
        problems.append(f"{name}: expected at most {MAX_LINES} lines, got {lines}; are there two ideas in it?")
    if name.endswith(".hpp") and "#pragma once" not in text:
        problems.append(f"{name}: a header without #pragma once")
    return problems


def broken_links(name, text, folder):
    return [
        f"{name}: the link to {target} leads nowhere"
        for target, _ in LINK.findall(text)
        if "://" not in target and not target.startswith("mailto:") and not (folder / target).exists()
    ]


def types_with_two_homes(headers):
    """Types of one name and namespace in two of `headers`, (name, text): the linker takes either and says nothing."""
    homes, problems = {}, []
    for name, text in headers:
        namespace = NAMESPACE.search(text)
        for found in TYPE.findall(text):
            home = homes.setdefault((namespace and namespace[1], found), name)
            if home != name:
                problems.append(f"{name}: {found} is a type of {home}, too; give one of them another name")
    return problems


def find_problems():
    headers = [(relative(path), path.read_text(encoding="utf-8")) for path in repository_files(".hpp")]
    problems = types_with_two_homes([header for header in headers if header[0].startswith(("src/", "apps/"))])
    problems += [f"{name}: not executable" for name in EXECUTABLES if not os.access(ROOT / name, os.X_OK)]
    for path in repository_files():
        name = relative(path)
        if path.stat().st_size > MAX_BYTES:
            problems.append(f"{name}: {path.stat().st_size} bytes; a repository holds small files")
        text = text_of(path)
        if text is None or name.startswith("tests/data/bad_inputs/"):
            continue
        problems += problems_of_text(name, text)
        if name.endswith(".md"):
            problems += broken_links(name, text, path.parent)
    return problems


def find_faults_of_this_check():
    """The check itself: each rule finds what it is for."""
    cases = [  # name, text, number of problems
        ("src/a.cpp", "// TO" + "DO later\n", 1),
        ("src/a.cpp", 'open("/wo' + 'rk/shared")\n', 1),
        ("docs/a.md", "see https://py" + "pi.org/x\n", 1),
        ("tests/a_test.cpp", "TEST(A, DIS" + "ABLED_b)\n", 1),
        ("tests/a_test.cpp", "GTEST_SK" + "IP();\n", 1),
        ("tests/a_test.cpp", "GTEST_SK" + 'IP() << "no CHOLMOD in this build";\n', 0),
        ("tests/a_test.cpp", "auto file = Temp" + 'Dir() + "a.bin";\n', 1),
        ("tests/a_test.cpp", "std::filesystem::temp_directory" + "_path();\n", 1),
        ("python/tests/test_a.py", "open('/t" + "mp/a')\n", 1),
        (HOME_OF_FOLDERS, "mkd" + "temp(name.data());\n", 0),
        ("src/a.cpp", "\n" * (MAX_LINES + 1), 1),
        ("src/a.hpp", "int f();\n", 1),
        ("src/a.hpp", "#pragma once\n/// network/cost and https://example.org/\n", 0),
    ]
    faults = []
    for name, text, expected in cases:
        found = problems_of_text(name, text)
        if len(found) != expected:
            faults.append(f"{name} with {text[:40]!r}: expected {expected} problems, got {found}")
    twice = [(f"src/{name}.hpp", "namespace resilin {\nstruct Both {\n};\n}") for name in ("a", "b")]
    if len(types_with_two_homes(twice)) != 1 or types_with_two_homes(twice[:1]):
        faults.append("a type with two homes is not found, or one with one is")
    if not broken_links("a.md", "[x](no-such-file.md)", pathlib.Path(ROOT)):
        faults.append("a broken link is not found")
    return faults


if __name__ == "__main__":
    found = find_problems()
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
