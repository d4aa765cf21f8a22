"""Puts the licences of everything that a repaired wheel carries into it: bundled_licences.py WHEEL.

Fails when the wheel holds a library that the table below does not know, or lacks one that it names.
"""

import base64
import hashlib
import importlib.metadata
import pathlib
import re
import sys
import zipfile

# Name of the file in resilin.libs, up to the hash -> project, licence, Debian package whose copyright file is added.
SHARED = {
    "libopenblasp": ("OpenBLAS", "BSD-3-Clause", "libopenblas0-pthread"),
    "libgfortran": ("GCC's Fortran library", "GPL-3.0-or-later with GCC Runtime Library Exception", "libgfortran5"),
    "libquadmath": ("GCC's quad-precision library", "LGPL-2.1-or-later", "libquadmath0"),
    "libmetis": ("METIS", "Apache-2.0", "libmetis5"),
    "libtbb": ("oneTBB", "Apache-2.0", "libtbb12"),
    "libfmt": ("{fmt}", "MIT", "libfmt9"),
    "libtomlplusplus": ("toml++", "MIT", "libtomlplusplus3"),
    "libfreetype": ("FreeType", "FTL (FreeType License)", "libfreetype6"),
    "libpng": ("libpng", "libpng License", "libpng16-16"),
    "libbrotlidec": ("Brotli", "MIT", "libbrotli1"),
    "libbrotlicommon": ("Brotli's tables", "MIT", "libbrotli1"),
}
COMPILED_IN = {  # headers and static libraries
    "Eigen": ("MPL-2.0", "libeigen3-dev"),
    "JSON for Modern C++": ("MIT", "nlohmann-json3-dev"),
    "Boost": ("BSL-1.0", "libboost1.74-dev"),
    "CLI11": ("BSD-3-Clause", "libcli11-dev"),
}
# With it `resilin export` writes pages. Its libraries are those of the package ziglang, which compiled it.
MODULE = "resilin/share/resilin/resilin_play.wasm"
IN_MODULE = {
    "libc++, libc++abi and libunwind of LLVM": ("Apache-2.0 with LLVM exceptions", "libcxx/LICENSE.TXT"),
    "wasi-libc": ("MIT, Apache-2.0 or Apache-2.0 with LLVM exceptions", "libc/wasi/LICENSE-MIT"),
}
FONT_LICENCE = pathlib.Path(__file__).parent.parent / "src/resilin/picture/DejaVuSans.LICENSE"
FILE_NAME = "licenses/bundled-libraries.txt"


def libraries(names):
    """File in resilin.libs -> its key in SHARED."""
    found = {}
    for name in names:
        if match := re.match(r"resilin\.libs/(lib[a-z+]+)", name):
            found[name] = match.group(1)
    return found


def copyright_of(package):
    return pathlib.Path("/usr/share/doc", package, "copyright").read_text(encoding="utf-8", errors="replace")


def zig_library(name):
    """The text of a file of the package ziglang, which scripts/build_wasm.sh has fetched."""
    tools = pathlib.Path(__file__).parent.parent / "build" / "wasm-tools"
    for package in tools.glob("venv/lib/python*/site-packages/ziglang/lib"):
        return (package / name).read_text(encoding="utf-8")
    sys.exit(f"{tools}: expected the package ziglang, of which {MODULE} was built; scripts/build_wasm.sh fetches it")


def text_for(found, has_module):
    """The list, then the terms themselves."""
    in_module = IN_MODULE if has_module else {}
    lines = ["This wheel carries, unchanged but for their names, these shared libraries of Debian:", ""]
    lines += [f"  {pathlib.PurePath(name).name}: {SHARED[key][0]}, {SHARED[key][1]}" for name, key in found.items()]
    lines += ["", "Compiled into the extension and the program:", ""]
    lines += [f"  {project}: {licence}" for project, (licence, _) in COMPILED_IN.items()]
    lines += ["  DejaVu Sans, a part of it: Bitstream Vera License"]
    lines += ["  nanobind: BSD-3-Clause", "  robin-map (in nanobind): MIT", ""]
    if in_module:
        lines += [f"Compiled into {MODULE}, besides Eigen and JSON for Modern C++:", ""]
        lines += [f"  {project}: {licence}" for project, (licence, _) in in_module.items()] + [""]
    lines += ["CHOLMOD is not among them: no part of the wheel is under the GPL alone.", ""]
    for project, _, package in SHARED.values():
        lines += ["=" * 100, project, "=" * 100, copyright_of(package)]
    for project, (_, package) in COMPILED_IN.items():
        lines += ["=" * 100, project, "=" * 100, copyright_of(package)]
    lines += ["=" * 100, "DejaVu Sans", "=" * 100, FONT_LICENCE.read_text(encoding="utf-8")]
    for project, (_, name) in in_module.items():
        lines += ["=" * 100, project, "=" * 100, zig_library(name)]
    nanobind = importlib.metadata.distribution("nanobind")
    for file in nanobind.files:
        if "licen" in file.name.lower():
            lines += ["=" * 100, f"nanobind: {file.name}", "=" * 100, file.read_text()]
    return "\n".join(lines)


def add_file(wheel, name, text):
    """Adds a file to the wheel's dist-info and to its RECORD."""
    with zipfile.ZipFile(wheel) as archive:
        entries = [(info, archive.read(info)) for info in archive.infolist()]
    record = next(info.filename for info, _ in entries if info.filename.endswith(".dist-info/RECORD"))
    path = record.replace("RECORD", name)
    data = text.encode()
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(path, data)
        for info, content in entries:
            if info.filename == path:
                continue
            if info.filename == record:
                lines = [line for line in content.decode().splitlines() if not line.startswith(path + ",")]
                content = "\n".join([*lines, f"{path},sha256={digest},{len(data)}", ""]).encode()
            archive.writestr(info, content, zipfile.ZIP_DEFLATED)


def main(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    found = libraries(names)
    if unknown := sorted(set(found.values()) - SHARED.keys()):
        sys.exit(f"{wheel}: carries {', '.join(unknown)}, of which {__file__} does not know the licence")
    if absent := sorted(SHARED.keys() - set(found.values())):
        sys.exit(f"{wheel}: expected it to carry {', '.join(absent)}; mend the table in {__file__}")
    add_file(wheel, FILE_NAME, text_for(found, MODULE in names))


if __name__ == "__main__":
    main(sys.argv[1])
