"""The images of containers/ have every library that the program in them asks for, and are built of what is there."""

import pathlib
import re
import subprocess

from files import ROOT

# Image -> the build folder whose program is as that of the image, but for CHOLMOD, which images leave out.
IMAGES = {"Dockerfile": "petsc", "program.Dockerfile": "release"}
LEFT_OUT = "libcholmod3"
BASE = {"libc6", "libgcc-s1", "libstdc++6", "zlib1g"}  # base of every Debian image: apt and dpkg need them
INSTALLS = re.compile(r"apt-get install -y --no-install-recommends\s+((?:[\w.+-]+\s+)+)")


def installed_packages(text):
    """Packages that the last stage of an image installs."""
    stage = text.replace("\\\n", " ").rpartition("\nFROM ")[2]
    return set(INSTALLS.search(stage)[1].split())


def output_of(*command, check=True):
    return subprocess.run(command, capture_output=True, text=True, check=check).stdout


def needed_packages(program):
    """Those of the libraries that the program itself names; their packages bring what they need in turn."""
    names = re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "-d", program))
    places = dict(re.findall(r"(\S+) => (/\S+)", output_of("ldd", program)))
    files = {str(pathlib.Path(places[name]).resolve()) for name in names if name in places}
    # A file may be known by the name that it had before /lib became a link to /usr/lib.
    found = output_of("dpkg", "-S", *files, *(file.removeprefix("/usr") for file in files), check=False)
    owner_of = {file: owner for owner, file in re.findall(r"^([^:\n]+).*: (?:/usr)?(/\S+)$", found, re.MULTILINE)}
    return {owner_of.get(file.removeprefix("/usr"), f"the owner of {file}") for file in files}


def brought_packages(packages):
    """These, and those that they depend on."""
    depends = output_of("dpkg-query", "-W", "-f", "${Depends},", *packages, check=False)
    return packages | {part.split()[0] for part in re.split(r"[,|]", depends) if part.strip()}


def problems_of(image, program):
    text = (ROOT / "containers" / image).read_text(encoding="utf-8")
    lacks = needed_packages(program) - brought_packages(installed_packages(text)) - BASE - {LEFT_OUT}
    return [f"containers/{image}: its program asks for {name}, which it does not install" for name in sorted(lacks)]


def find_problems():
    """Problems of the images whose program is built here."""
    problems = []
    for image, preset in IMAGES.items():
        program = ROOT / "build" / preset / "apps" / "cli" / "resilin"
        if program.exists():
            problems += problems_of(image, program)
    return problems


def find_faults_of_this_check():
    text = "FROM debian:12 AS build\nRUN apt-get install -y --no-install-recommends g++ \\\n  cmake && true\n"
    text += "FROM debian:12\nRUN x apt-get install -y --no-install-recommends \\\n    liba1 libb2.3 openmpi-bin && rm\n"
    found = installed_packages(text)
    return [] if found == {"liba1", "libb2.3", "openmpi-bin"} else [f"containers: packages of a text: {found}"]
