"""The gallery: a page for each scene of examples/, with its picture, its film and, where asked for, a page to play in.

Pictures are made by running the scenes, once: they are kept beside the site until the program or the scene changes.
"""

import dataclasses
import hashlib
import html
import json
import re
import shutil
import subprocess
import sys
import tomllib

from files import ROOT, relative, repository_files
from website.pages import code_block

EXAMPLES = ROOT / "examples"
SETTINGS = ROOT / "scripts" / "website" / "gallery.toml"
ROW = re.compile(r"^\| \[[^\]]+\]\(([^)]+\.toml)\) \| (.*) \|$", re.MULTILINE)
TITLE = re.compile(r'^title = "(.*)"$', re.MULTILINE)
FILM_SIZE = ("720", "540")
FIRST_LINES = re.compile(r"\A((?:# .*\n)+)")


@dataclasses.dataclass
class Scene:
    name: str  # "heap"
    caption: str  # caption of the table in examples/README.md, Markdown
    plays: bool = False
    still: float = 1.0  # the share of the film at which its picture is taken
    options: list = dataclasses.field(default_factory=list)  # options of `resilin film` and `resilin picture`
    shown: dict = dataclasses.field(default_factory=dict)  # kind -> name of a file: "picture", "film", "play"

    @property
    def source(self):
        return EXAMPLES / f"{self.name}.toml"

    @property
    def title(self):
        found = TITLE.search(self.source.read_text(encoding="utf-8"))
        return found[1] if found else self.name

    @property
    def is_run(self):
        """Fits have a page of their own and no frames."""
        return "simulation" in tomllib.loads(self.source.read_text(encoding="utf-8"))


def settings():
    return tomllib.loads(SETTINGS.read_text(encoding="utf-8"))


def scenes():
    """Those of the table in examples/README.md, in its order."""
    own = settings()["scene"]
    text = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    found = []
    for target, caption in ROW.findall(text):
        if "/" not in target:
            name = target.removesuffix(".toml")
            look = own.get(name, {})
            plays, still = look.get("play", False), look.get("still", 1.0)
            found.append(Scene(name, caption, plays, still, look.get("options", [])))
    unknown = set(own) | set(settings()["strip"])
    unknown -= {scene.name for scene in found}
    if unknown:
        raise ValueError(f"{relative(SETTINGS)}: {', '.join(sorted(unknown))}: no scene of examples/README.md")
    return found


def fingerprint(scene, program):
    """Hash of all that a picture depends on: program, scene, meshes, look."""
    digest = hashlib.sha256()
    meshes = repository_files(".msh", ".obj", ".mesh", ".veg", ".csv")
    for path in [program, scene.source, *(mesh for mesh in meshes if mesh.parent in (EXAMPLES, ROOT / "data"))]:
        digest.update(path.read_bytes())
    digest.update(json.dumps([scene.options, FILM_SIZE]).encode())
    return digest.hexdigest()


def run(*command, cwd=None):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: exit code {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


def frames_of(results):
    return json.loads((results / "report.json").read_text(encoding="utf-8"))["frames"]


def draw(scene, program, folder):
    """Runs the scene and writes its film, where there is motion, and its picture into `folder`."""
    results = folder / "run"
    run(program, "run", scene.source, "--out", results, "--quiet", "--formats", "vtu")
    look = ["--size", *FILM_SIZE, *scene.options]
    if len(frames_of(results)) > 4 and shutil.which("ffmpeg"):
        run(program, "film", results, "--out", folder / f"{scene.name}.mp4", *look)
    else:
        run(program, "picture", results, "--out", folder / f"{scene.name}.png", *look)
    shutil.rmtree(results)


def take_still(film, picture, share):
    """The picture of a film at a share of its length: it stands where the film will play."""
    said = run("ffprobe", "-v", "error", "-show_entries", "stream=nb_frames", "-of", "csv=p=0", film)
    number = min(int(share * int(said)), int(said) - 1)
    chosen = ["-vf", f"select=eq(n\\,{number})", "-frames:v", "1"]
    picture.unlink(missing_ok=True)
    run("ffmpeg", "-y", "-loglevel", "error", "-i", film, *chosen, picture)
    if not picture.is_file():
        raise RuntimeError(f"{film.name}: ffmpeg gave no picture {number} of {int(said)}")


def make_pictures(found, program, kept, files):
    """Draws these scenes and fills their `shown`.

    `kept` is the folder that outlives a build; `files` goes into the site as it is.
    """
    for number, scene in enumerate(found):
        folder = kept / scene.name
        stamp = folder / "stamp"
        wanted = fingerprint(scene, program)
        if scene.is_run and (not stamp.is_file() or stamp.read_text() != wanted):
            print(f"drawing {scene.name} ({number + 1} of {len(found)}) ...", file=sys.stderr, flush=True)
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            draw(scene, program, folder)
            stamp.write_text(wanted)
        if (film := folder / f"{scene.name}.mp4").is_file():
            take_still(film, film.with_suffix(".png"), scene.still)
        for kind, suffix in (("picture", ".png"), ("film", ".mp4")):
            if (folder / f"{scene.name}{suffix}").is_file():
                put(folder / f"{scene.name}{suffix}", files / "gallery")
                scene.shown[kind] = f"gallery/{scene.name}{suffix}"


def make_pages_to_play(found, program, kept, files, module):
    """Makes pages of these scenes, into the same folders."""
    for scene in found:
        page = kept / scene.name / f"{scene.name}.html"
        page.parent.mkdir(parents=True, exist_ok=True)
        if not page.is_file() or page.stat().st_mtime < module.stat().st_mtime:
            run(program, "export", scene.source, page, "--engine", module)
        put(page, files / "play")
        scene.shown["play"] = f"play/{scene.name}.html"


def put(path, folder):
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy2(path, folder / path.name)


def as_html(caption):
    """A caption without links, for inside of one."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", caption)
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", html.escape(plain, quote=False))


def moving_or_still(scene, up):
    """The film, else the picture, as HTML; `up` leads to the root of the site."""
    about = html.escape(re.sub(r"<[^>]+>", "", as_html(scene.caption)), quote=True)
    picture = scene.shown.get("picture")
    if film := scene.shown.get("film"):
        files = f'src="{up}{film}" poster="{up}{picture}"'
        return f'<video {files} muted loop playsinline preload="none" aria-label="{about}"></video>'
    return f'<img src="{up}{picture}" alt="{about}" loading="lazy">' if picture else ""


def card(scene, up):
    badge = '<span class="badge">play</span>' if "play" in scene.shown else ""
    return (
        f'<a class="card" href="{up}examples/{scene.name}.html">{moving_or_still(scene, up)}{badge}'
        f"<span>{as_html(scene.caption)}</span></a>"
    )


def cards(found, up):
    return '<div class="gallery">\n' + "\n".join(card(scene, up) for scene in found) + "\n</div>\n"


def scene_page(scene):
    text = scene.source.read_text(encoding="utf-8")
    first = FIRST_LINES.match(text)
    said = " ".join(line.removeprefix("# ").strip() for line in first[1].splitlines()) if first else scene.caption
    said = said.replace("<", "&lt;")
    parts = [f"# {scene.title}\n", said + "\n"]
    if shown := moving_or_still(scene, "../"):
        parts.append(f'<div class="stage">{shown.replace("<video ", "<video controls ", 1)}</div>\n')
    if play := scene.shown.get("play"):
        parts.append(f'<p><a class="button" href="../{play}">Play with it here</a></p>\n')
    command = "run" if scene.is_run else "fit"
    typed = f"./run examples/{scene.name}.toml" if scene.is_run else f"./run fit examples/{scene.name}.toml"
    words = [f"`{typed}` {command}s it"]
    if scene.is_run:
        words.append(f"`./run view examples/{scene.name}.toml` opens it in the browser, to be pulled at")
    if "play" in scene.shown:
        words.append(f"`./run export examples/{scene.name}.toml play.html` made the page above")
    parts.append(", ".join(words) + f" ([{command}](../reference/commands.md)).\n")
    parts.append(code_block(text, "toml"))
    return "\n".join(parts)


def with_cards(text, found):
    """The page of examples/README.md with pictures where its table begins."""
    shown = [scene for scene in found if "picture" in scene.shown]
    return re.sub(r"(?=^\| scene \|)", lambda _: cards(shown, "../") + "\n", text, count=1, flags=re.MULTILINE)


def buttons(found):
    """Where to go from the first page; the first place stands out."""
    places = [
        ("docs/tutorials/index.html", "Get started"),
        ("examples/index.html", "Gallery"),
        ("docs/scene.html", "Scene reference"),
        ("reference/python.html", "Python API"),
    ]
    playable = [scene for scene in found if "play" in scene.shown]
    places[1:1] = [(scene.shown["play"], "Play in the browser") for scene in playable[:1]]
    kinds = ["button"] + ["button quiet"] * (len(places) - 1)
    links = "".join(
        f'<a class="{kind}" href="{place}">{html.escape(words)}</a>'
        for kind, (place, words) in zip(kinds, places, strict=True)
    )
    return f'<p class="actions">{links}</p>\n'


def strip(found):
    """The cards of the first page."""
    by_name = {scene.name: scene for scene in found}
    return cards([by_name[name] for name in settings()["strip"]], "")
