"""Builds the site with few pictures of the gallery, follows every link in it that leads to the site itself, and reads,
searches and plays in it in a real browser, where what tests the page is installed."""

import html.parser
import os
import pathlib
import re
import subprocess
import tempfile
import urllib.parse

import check_browser
from files import ROOT

BUILDER = ROOT / "scripts" / "website" / "build.py"
INTERPRETER = ROOT / "build" / "site" / "venv" / "bin" / "python"  # made by setup.sh
PROGRAM = ROOT / "build" / "release" / "apps" / "cli" / "resilin"
TIME_LIMIT = 900  # [s] when it hangs; it takes seconds on quiet cores
DRAWN = ("beam_2d", "twisted_bar")  # a picture and a film
PLAYED = "jelly_cube"
LISTED = "mesh"  # the module whose headers are listed here; all of them take as long as the rest together
LOADED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("video", "src"), ("video", "poster")}
STYLED = re.compile(r"""url\(["']?(?!data:)([^"')]+)|@import\s+["']([^"']+)""")


class Page(html.parser.HTMLParser):
    """Links of a page, files that it loads, and its anchors."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.anchors = [], [], {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        for name in ("href", "src", "poster"):
            if name in values and "canonical" not in values.get("rel", ""):
                (self.loaded if (tag, name) in LOADED else self.links).append(values[name])


def is_elsewhere(link):
    return urllib.parse.urlsplit(link).scheme in ("http", "https", "mailto") or link.startswith("//")


def problems_of(folder):
    """Links that lead nowhere, and what would be asked of other hosts."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    problems = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        problems += [f"{name}: loads {link} from another host" for link in page.loaded if is_elsewhere(link)]
        for link in {*page.links, *page.loaded}:
            if is_elsewhere(link) or link.startswith(("data:", "javascript:")):
                continue
            parts = urllib.parse.urlsplit(link)
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                problems.append(f"{name}: the link to {link} leads nowhere")
            elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                problems.append(f"{name}: the link to {link} leads to no place of that page")
    for path in folder.rglob("*.css"):
        for link in STYLED.findall(path.read_text(encoding="utf-8")):
            if is_elsewhere("".join(link)):
                problems.append(f"{path.relative_to(folder)}: loads {''.join(link)} from another host")
    return problems


def what_is_missing(folder):
    """Pages that must be there, with a word of each, and the index that a page opened from disk can search."""
    wanted = {
        "index.html": "The same scene as a TOML file",
        "docs/scene.html": "youngs_modulus",
        "docs/validation.html": "relative error",
        "docs/theory/real_time.html": "<math",
        "examples/heap.html": "opens it in the browser",
        "examples/notebooks/from_surface_to_result.html": "Where it is strained most",
        "reference/commands.html": "resilin gradcheck",
        "reference/python.html": 'id="resilin.Mesh.box"',
        f"reference/cpp/{LISTED}.html": "find_solid",
        "searchindex.js": "Search.setIndex",
    }
    problems = []
    for name, word in wanted.items():
        path = folder / name
        if not path.is_file() or word not in path.read_text(encoding="utf-8"):
            problems.append(f"{name}: expected a page with {word!r}")
    return problems


def command(folder):
    """Command that builds the site of `folder`."""
    few = ["--no-pictures", "--pictures", *DRAWN, "--play", PLAYED, "--modules", LISTED]
    return [INTERPRETER, BUILDER, *few, "--out", folder / "site", "--work", folder / "work"]


def build_problems(folder):
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        run = subprocess.run(
            command(folder), capture_output=True, text=True, check=False, timeout=TIME_LIMIT, env=environment
        )
    except subprocess.TimeoutExpired:
        return [f"the site was not built within {TIME_LIMIT} s"]
    if run.returncode != 0:
        return (run.stdout + run.stderr).splitlines()[-30:]
    return what_is_missing(folder / "site") + problems_of(folder / "site")


def outcomes():
    """(name, status, detail) of each test."""
    built, read = "the site is built, and every link in it leads somewhere", "the site is read in a browser"
    if not INTERPRETER.is_file() or not PROGRAM.is_file():
        return [(name, "skipped", "what makes the site is not installed") for name in (built, read)]
    with tempfile.TemporaryDirectory(prefix="resilin-site-") as name:
        folder = pathlib.Path(name).resolve()
        problems = build_problems(folder)
        results = [(built, "failed" if problems else "passed", "\n".join(problems))]
        if not (folder / "site" / "index.html").is_file():
            return results
        if not check_browser.is_installed():
            return [*results, (read, "skipped", "./test browser installs what reads it")]
        return results + check_browser.browser_outcomes("site/site", RESILIN_SITE=str(folder / "site"))


def find_faults_of_this_check():
    """Links that lead nowhere are found, and those that hold are not."""
    first = (
        '<a href="b.html#there">x</a><a href="b.html#nowhere">x</a><a href="c.html">x</a>'
        '<a id="here" href="#here">x</a><script src="https://example.org/x.js"></script>'
        '<a href="https://example.org/">x</a><img src="d.png">'
    )
    with tempfile.TemporaryDirectory(prefix="resilin-site-") as name:
        folder = pathlib.Path(name).resolve()
        (folder / "a.html").write_text(first, encoding="utf-8")
        (folder / "b.html").write_text('<p id="there"></p>', encoding="utf-8")
        styles = '@import "https://example.org/x.css"; b { background: url(e.css) }'
        (folder / "e.css").write_text(styles, encoding="utf-8")
        found = problems_of(folder)
    wrong = ["b.html#nowhere", "c.html", "d.png", "https://example.org/x.js", "https://example.org/x.css"]
    if len(found) != len(wrong) or any(not any(word in problem for problem in found) for word in wrong):
        return [f"links that lead nowhere: got {found}"]
    return []
