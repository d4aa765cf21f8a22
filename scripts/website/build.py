"""Builds the site of what stands in the repository: pages, scenes, notebooks, docstrings, headers, the program's help.

scripts/build_site.sh makes what this needs and calls it. Every warning of Sphinx (a link or an anchor that leads
nowhere) is an error.
"""

import argparse
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

from files import ROOT, project_version, relative, repository_files  # noqa: E402
from website import command_reference, cpp_reference, gallery, notebooks, python_reference  # noqa: E402
from website.pages import (  # noqa: E402
    Links,
    Stage,
    code_block,
    glossary_entries,
    listing,
    listing_name,
    page_names,
    staged_name,
    with_index_entries,
)

HERE = pathlib.Path(__file__).resolve().parent
BUILD = ROOT / "build" / "site"
PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"
MODULE = ROOT / "build" / "wasm" / "apps" / "play" / "resilin_play.wasm"
UNLISTED = ("README.md",)


def contents(pages):
    """(caption, documents) of navigation.toml; pages that it does not name come where it says `rest`."""
    chapters = tomllib.loads((HERE / "navigation.toml").read_text(encoding="utf-8"))["chapter"]
    named = {page for chapter in chapters for page in chapter["pages"]}
    left = [page for page in pages if page not in named and page not in UNLISTED]
    for chapter in chapters:
        listed = list(chapter["pages"])
        if folder := chapter.get("folder"):
            own = [page for page in left if page.startswith(folder)]
            listed += own
            left = [page for page in left if page not in own]
        chapter["listed"] = listed
    chapters[-1]["listed"] += left
    return [
        (chapter["caption"], [staged_name(page).rsplit(".", 1)[0] for page in chapter["listed"]])
        for chapter in chapters
    ]


def toctrees(pages):
    parts = []
    for caption, documents in contents(pages):
        head = f"```{{toctree}}\n:caption: {caption}\n:hidden:\n:maxdepth: 1\n\n"
        parts.append(head + "\n".join(documents) + "\n```\n")
    return "\n".join(parts)


def first_page(text, scenes, pages):
    """README with its first lines beside its first picture, buttons below them, then the gallery's strip."""
    title, first, picture, install, rest = re.fullmatch(
        r"(# .*?\n)(.*?)^(!\[.*?\]\(.*?\)\n)(.*?)(^## .*)", text, re.MULTILINE | re.DOTALL
    ).groups()
    sentence, code = first.split("\n```", 1)
    column = [sentence, gallery.buttons(scenes), "```" + code, install]
    parts = ["---\nhide-toc: true\n---\n" + title, '<div class="hero"><div>\n', *column, "</div><div>\n", picture]
    parts.append("</div></div>\n")
    if any("picture" in scene.shown for scene in scenes):
        parts.append(gallery.strip(scenes))
    return "\n".join([*parts, rest, toctrees(pages)])


def write_pages(stage, scenes, files, runs_notebooks, modules):
    names = page_names()
    books = repository_files(".ipynb")
    examples = {relative(scene.source): f"examples/{scene.name}.md" for scene in scenes}
    examples |= {relative(book): relative(book).removesuffix(".ipynb") + ".md" for book in books}
    links = Links(names, examples)
    entries = glossary_entries((ROOT / "docs" / "glossary.md").read_text(encoding="utf-8"))
    for name in names:
        text = links.rewrite(name, (ROOT / name).read_text(encoding="utf-8"))
        if name == "README.md":
            text = first_page(text, scenes, names)
        elif name == "examples/README.md":
            text = gallery.with_cards(text, scenes)
            pages = [f"{scene.name}" for scene in scenes] + [
                examples[relative(book)].removeprefix("examples/").removesuffix(".md") for book in books
            ]
            text += "\n```{toctree}\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"
        own = {anchor: words for (page, anchor), words in entries.items() if "docs/" + page == name}
        text = with_index_entries(text, own) if own else text
        stage.write(staged_name(name), text)
    for scene in scenes:
        stage.write(examples[relative(scene.source)], gallery.scene_page(scene))
    for book in books:
        name = examples[relative(book)]
        text = notebooks.page(book, files, runs_notebooks).replace("UP/", "../" * name.count("/"))
        stage.write(name, links.rewrite(relative(book), text))
    stage.write("reference/commands.md", command_reference.page(PROGRAM))
    stage.write("reference/python.rst", python_reference.page())
    for name, text in cpp_reference.pages(code_block, modules):
        stage.write(f"reference/cpp/{name}.md", text)
    for path in sorted(links.listed):
        stage.write(listing_name(path), listing(path))
    for path in sorted(links.pictures):
        stage.write(path, (ROOT / path).read_bytes())


def build(out, work, *, drawn, played, runs_notebooks, modules=None):
    """Writes the site into `out`; what is kept from build to build is in `work`.

    `drawn`, `played`: names of scenes that get a picture and a page to play with; None: all of the gallery.
    Raises RuntimeError with what Sphinx said.
    """
    if not PROGRAM.is_file():
        raise RuntimeError(f"{PROGRAM}: not there; scripts/build_site.sh builds it")
    work.mkdir(parents=True, exist_ok=True)
    with open(work / "lock", "w") as lock:  # ends with this process
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RuntimeError(f"{work}: another build of the site is at work there; wait for its end") from None
        build_alone(out, work, drawn, played, runs_notebooks, modules)


def is_among(name, names):
    return names is None or name in names


def build_alone(out, work, drawn, played, runs_notebooks, modules):
    files = work / "files"
    shutil.rmtree(files, ignore_errors=True)
    files.mkdir(parents=True)
    scenes = gallery.scenes()
    pictures = work / "pictures"
    gallery.make_pictures([scene for scene in scenes if is_among(scene.name, drawn)], PROGRAM, pictures, files)
    if MODULE.is_file():
        playable = [scene for scene in scenes if scene.plays and is_among(scene.name, played)]
        gallery.make_pages_to_play(playable, PROGRAM, pictures, files, MODULE)
    stage = Stage(work / "pages")
    write_pages(stage, scenes, files, runs_notebooks, modules)
    stage.remove_what_is_old()
    environment = {**os.environ, "RESILIN_VERSION": project_version(), "RESILIN_SITE_FILES": str(files)}
    # -a: Sphinx keeps the index entries of a search from no earlier build, so all pages are written.
    command = [sys.executable, "-m", "sphinx", "-q", "-a", "-W", "--keep-going", "-j", "auto", "-b", "html"]
    command += ["-c", HERE, "-d", work / "doctrees", stage.folder, out]
    run = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.replace(str(stage.folder) + "/", "").strip() or run.stdout.strip())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "site", help="default out/site")
    parser.add_argument("--work", type=pathlib.Path, default=BUILD, help="what is kept from build to build")
    parser.add_argument("--modules", nargs="*", help="of the C++ reference; default all")
    parser.add_argument("--no-pictures", action="store_true", help="run no notebooks, and no scenes but those named")
    parser.add_argument("--pictures", nargs="*", metavar="SCENE", help="that are drawn; default all")
    parser.add_argument("--play", nargs="*", metavar="SCENE", help="that are pages to play with; default all")
    arguments = parser.parse_args()
    try:
        unnamed = () if arguments.no_pictures else None
        drawn = unnamed if arguments.pictures is None else arguments.pictures
        played = unnamed if arguments.play is None else arguments.play
        out, work = arguments.out.resolve(), arguments.work.resolve()
        runs_notebooks = not arguments.no_pictures
        build(out, work, drawn=drawn, played=played, runs_notebooks=runs_notebooks, modules=arguments.modules)
    except (RuntimeError, ValueError, FileNotFoundError) as error:
        sys.exit(f"The site could not be built: {error}")
    if not MODULE.is_file() and not arguments.no_pictures:
        print("No pages to play with: scripts/build_wasm.sh makes what they need", file=sys.stderr)
    print(f"{arguments.out / 'index.html'}: {sum(1 for _ in arguments.out.rglob('*.html'))} pages")


if __name__ == "__main__":
    main()
