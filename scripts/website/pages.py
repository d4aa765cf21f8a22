"""Pages of the repository as pages of the site: where they stand there, and where their links lead.

A page keeps its folder, so that most links hold as they are; README.md of a folder becomes its index. Links to scenes
lead to the pages of the gallery, links to other files and folders to pages that list them.
"""

import dataclasses
import pathlib
import posixpath
import re

from files import ROOT, relative, repository_files

LINK = re.compile(r"(?P<code>`+).+?(?P=code)|(?<=\]\()(?P<link>[^)\s]+)(?=\))")  # links, and code, which holds none
FENCE = re.compile(r"^(```|~~~)")
PICTURES = (".png", ".gif", ".jpg", ".svg", ".webp")
LANGUAGES = {
    ".cpp": "cpp",
    ".hpp": "cpp",
    ".py": "python",
    ".toml": "toml",
    ".json": "json",
    ".sh": "sh",
    "CMakeLists.txt": "cmake",
}
LISTED_BYTES = 16_000  # listed bytes of a file whose text is shown
NOT_PAGES = ("tests/", "shared/")  # folders whose Markdown is data


@dataclasses.dataclass
class Stage:
    """The folder that the site is made of, which keeps what has not changed as it is, and so its dates."""

    folder: pathlib.Path
    written: set = dataclasses.field(default_factory=set)

    def write(self, name, content):
        path = self.folder / name
        self.written.add(path)
        data = content.encode() if isinstance(content, str) else content
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def remove_what_is_old(self):
        for path in self.folder.rglob("*"):
            if path.is_file() and path not in self.written:
                path.unlink()


def page_names():
    """Every page that stands in the repository, relative to it."""
    names = [relative(path) for path in repository_files(".md")]
    return [name for name in names if not name.startswith(NOT_PAGES)]


def staged_name(page):
    """Where a page stands in the site."""
    folder, name = posixpath.split(page)
    return posixpath.join(folder, "index.md") if name == "README.md" else page


class Links:
    """Where a link of a page leads on the site, and what has to be there for it."""

    def __init__(self, pages, examples):
        self.pages = set(pages)
        self.examples = dict(examples)  # file of a scene or a notebook -> its page
        self.listed = set()  # files and folders that need a page that lists them
        self.pictures = set()

    def target(self, page, link):
        if "://" in link or link.startswith(("#", "mailto:")):
            return link
        place, _, anchor = link.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(page), place))
        return posixpath.relpath(self.home(path), posixpath.dirname(staged_name(page)) or ".") + (
            "#" + anchor if anchor else ""
        )

    def home(self, path):
        """The staged file that stands for a file of the repository."""
        if path in self.pages:
            return staged_name(path)
        if posixpath.join(path, "README.md") in self.pages:
            return staged_name(posixpath.join(path, "README.md"))
        if path in self.examples:
            return self.examples[path]
        if path.endswith(PICTURES):
            self.pictures.add(path)
            return path
        if not (ROOT / path).exists():
            raise FileNotFoundError(path)
        self.listed.add(path)
        return listing_name(path)

    def rewrite(self, page, text):
        """The text of a page with links that hold on the site."""

        def led(match):
            if match["code"]:
                return match[0]
            try:
                return self.target(page, match["link"])
            except FileNotFoundError as error:
                raise FileNotFoundError(f"{page}: the link to {match['link']} leads to nothing, {error}") from None

        lines, is_code = [], False
        for line in text.splitlines():
            if FENCE.match(line):
                is_code = not is_code
            lines.append(line if is_code else LINK.sub(led, line))
        return "\n".join(lines) + "\n"


def glossary_entries(text):
    """(page relative to docs/, anchor or "") -> words, from the second table of docs/glossary.md.

    The page is the first link of a row. Raises ValueError for a row without one.
    """
    entries = {}
    for line in text.partition("\n## From a word to the place")[2].splitlines()[3:]:
        words, place = re.fullmatch(r"\| (.*) \| (.*) \|", line).groups()
        link = re.search(r"\]\(([^)#]+)#?([^)]*)\)", place)
        if link is None:
            raise ValueError(f"docs/glossary.md: {words}: no link to a page")
        entries.setdefault(link.groups(), []).extend(word.strip(" `") for word in words.split(", "))
    return entries


def with_index_entries(text, entries):
    """The text of a page whose search index has `entries`, anchor -> words, at their headings."""
    left, lines, is_code = dict(entries), [], False
    for line in text.splitlines():
        is_code ^= bool(FENCE.match(line))
        lines.append(line)
        if is_code or not line.startswith("#"):
            continue
        title = re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower()).strip().replace(" ", "-")
        for anchor in {title, "" if line.startswith("# ") else title} & set(left):
            lines += ["", "```{index} " + ", ".join("!" + word for word in left.pop(anchor)), "```", ""]
    if left:
        raise ValueError(f"docs/glossary.md: no headings {', '.join(left)}")
    return "\n".join(lines) + "\n"


def listing_name(path):
    return f"files/{path}.md" if (ROOT / path).is_file() else f"files/{path}/index.md"


def language(path):
    return LANGUAGES.get(path.name, LANGUAGES.get(path.suffix, "text"))


def code_block(text, kind):
    return f"~~~~~~{kind}\n{text.rstrip()}\n~~~~~~\n"


def text_to_show(path):
    """The text of a file, or None for one that is too long or no text."""
    if path.stat().st_size > LISTED_BYTES:
        return None
    data = path.read_bytes()
    return None if b"\0" in data else data.decode("utf-8", errors="replace")


def listing(path):
    """A page for a file, or for a folder and the files in it."""
    place = ROOT / path
    parts = [f"---\norphan: true\nnosearch: true\n---\n# {path}\n"]
    if place.is_file():
        text = text_to_show(place)
        parts.append(size_line(place) if text is None else code_block(text, language(place)))
        return "\n".join(parts)
    files = [file for file in repository_files() if place in file.parents]
    for file in files:
        text = text_to_show(file) if file.suffix in LANGUAGES else None
        parts.append(f"## {file.relative_to(place).as_posix()}\n")
        parts.append(size_line(file) if text is None else code_block(text, language(file)))
    return "\n".join(parts)


def size_line(path):
    return f"{path.stat().st_size / 1000:.0f} kB, in the clone as `{relative(path)}`.\n"
