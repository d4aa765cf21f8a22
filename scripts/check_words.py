"""Rules about words in README.md, docs/ and comments that a machine can check; each problem is a line with its place.

Sentences have at most MAX_WORDS words and lines MAX_COLUMNS columns, headings and help texts use the field's terms,
and every comment and docstring names its thing first.
"""

import ast
import io
import re
import sys
import tokenize

from files import relative, repository_files

MAX_WORDS = 25
MAX_COLUMNS = 120
# Printed by the program, or by validation/run.py, whose sources and tolerances are quoted whole.
GENERATED = ("docs/scene.md", "docs/laws.md", "docs/fit_keys.md")
DIARIES = "docs/notes/"  # attempts and measurements, for developers

# Pages that do not comply yet.
LONG_SENTENCES_LEFT = ()
LONG_LINES_LEFT = ()
HEADINGS_LEFT = ()

# The field's terms for our own words.
FIELD_TERMS = {
    r"supports?\b": "boundary condition, prescribed displacement",
    r"what is held": "boundary condition, prescribed displacement",
    r"pressure that follows": "follower pressure",
    r"at rest and in motion": "static and dynamic",
    r"in motion": "dynamic, transient",
    r"rest shapes?": "reference configuration, inverse design",
    r"what was drawn": "target shape",
    r"unknowns": "degrees of freedom",
    r"inside out": "inverted element",
    r"folded": "inverted element",
    r"formed anew": "updated",
    r"going back": "adjoint pass",
    r"slopes": "sensitivities, derivatives",
    r"error (?:by|of) the (?:size of the )?cells": "discretisation error",
    r"one pressure (?:per|for each|in each) cell|with one pressure": "mixed displacement-pressure element",
    r"free vibrations?": "modal analysis",
    r"several processes|many processes": "MPI, distributed",
}

FENCE = re.compile(r"^\s*(```|~~~)")
LIST_ITEM = re.compile(r"^\s*(?:[-*+]|\d+\.)\s+")
SENTENCE_END = re.compile(r"(?<=[.!?])[\")*_]*(?:\s+|$)")
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|et al|vs|Fig|eq|ch|art|Dr|no|approx)\.")
WORD = re.compile(r"[A-Za-zÀ-ÿ][\w'’-]*(?:/[A-Za-z][\w'-]*)*")
FORMULA = re.compile(r"^( {4,}|\t)")
COMMENT = re.compile(r"^\s*(?://[/!]?(?!/)|/\*\*)\s?(.*)$")
BESIDE = re.compile(r"\S\s+//+<?\s(.*)$")  # a comment after code
DANGLING = re.compile(r"(?:Of|That|Which|What|Whose|Than|(?:With|By|In|From) (?:which|what|whom))\b", re.IGNORECASE)
HELP = re.compile(r'\b(?:option|flag|command|add_\w+)\(\s*"[^"]*",[^";]*((?:"[^"]*"\s*)+)')


def pages():
    names = [(relative(path), path) for path in repository_files(".md")]
    return [
        (name, path.read_text(encoding="utf-8"))
        for name, path in names
        if name == "README.md" or (name.startswith("docs/") and name not in GENERATED and not name.startswith(DIARIES))
    ]


def without_addresses(text):
    """Links and pictures as their words."""
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"<?https?://\S+>?", "", text)


def words_in(sentence):
    """Words of a sentence; code and formulas are none."""
    text = re.sub(r"`[^`]*`|\$[^$]*\$", " ", sentence)
    tokens = (token for token in text.split() if not re.search(r"[=^_|<>]|\w\(", token))
    return [word for token in tokens for word in WORD.findall(token)[:1]]


def paragraphs(text):
    """(line number, text) of each paragraph, heading and point of a list, without code and tables."""
    block, start, is_code = [], 0, False

    def whole():
        return (start, " ".join(block))

    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            is_code = not is_code
        if is_code or FENCE.match(line) or not line.strip() or line.lstrip().startswith(("|", "<", "#")):
            if block:
                yield whole()
            block = []
            if not is_code and line.startswith("#"):
                yield number, line.lstrip("# ")
            continue
        if not block and FORMULA.match(line):
            continue
        if LIST_ITEM.match(line) and block:
            yield whole()
            block = []
        if not block:
            start = number
        block.append(LIST_ITEM.sub("", line).strip())
    if block:
        yield whole()


def sentences(text):
    """(line number of its paragraph, sentence)."""
    for number, paragraph in paragraphs(text):
        plain = ABBREVIATION.sub(r"\1", without_addresses(paragraph))
        for sentence in SENTENCE_END.split(plain):
            if sentence.strip():
                yield number, sentence.strip()


def long_sentences(name, text):
    return [
        f"{name}:{number}: a sentence of {len(words_in(sentence))} words, at most {MAX_WORDS}: {sentence[:60]} ..."
        for number, sentence in sentences(text)
        if len(words_in(sentence)) > MAX_WORDS
    ]


def long_lines(name, text):
    """Tables, formulas and what a program prints (```text) may be wider, and lines by the address of a link.

    README has nothing wider: it is read as it stands.
    """
    problems, fence = [], None
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            fence = None if fence is not None else line.strip("` ")
        is_free = fence == "text" or (fence is None and (FORMULA.match(line) or line.lstrip().startswith("|")))
        width = len(re.sub(r"\]\([^)]*\)", "]()", line))
        if len(line) > MAX_COLUMNS if name == "README.md" else not is_free and width > MAX_COLUMNS:
            problems.append(f"{name}:{number}: {len(line)} columns, at most {MAX_COLUMNS}")
    return problems


def home_made_terms(place, text):
    return [
        f'{place}: "{found[0]}" in "{text[:60]}": the field says {term}'
        for ours, term in FIELD_TERMS.items()
        if (found := re.search(rf"\b{ours}", text, re.IGNORECASE))
    ]


def headings(name, text):
    is_code, problems = False, []
    for number, line in enumerate(text.splitlines(), 1):
        is_code ^= bool(FENCE.match(line))
        if not is_code and line.startswith("#"):
            problems += home_made_terms(f"{name}:{number}", line.lstrip("# "))
    return problems


def help_texts(name, text):
    problems = []
    for match in HELP.finditer(text):
        place = f"{name}:{text.count(chr(10), 0, match.start()) + 1}"
        problems += home_made_terms(place, re.sub(r'"\s*"', "", match[1].strip()).strip('"'))
    return problems


def dangling(place, text):
    if not (found := DANGLING.match(text)):
        return []
    return [f'{place}: a comment that begins with "{found[0]}": name the thing first']


def dangling_comments(name, text):
    """Comments of C++ and TypeScript: the first line of a block, and those after code."""
    problems, is_comment = [], False
    for number, line in enumerate(text.splitlines(), 1):
        comment, beside = COMMENT.match(line), BESIDE.search(line)
        if comment and not is_comment:
            problems += dangling(f"{name}:{number}", comment[1])
        elif beside and not comment:
            problems += dangling(f"{name}:{number}", beside[1])
        is_comment = bool(comment)
    return problems


def dangling_python(name, text):
    """Docstrings and comments of Python."""
    problems, last = [], 0
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            problems += dangling(f"{name}:{getattr(node, 'lineno', 1)}", ast.get_docstring(node) or "")
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            is_alone, number = token.line.lstrip().startswith("#"), token.start[0]
            if not (is_alone and last == number - 1):
                problems += dangling(f"{name}:{number}", token.string.lstrip("#: "))
            last = number if is_alone else 0
    return problems


def is_left(name, left):
    return any(name == entry or (entry.endswith("/") and name.startswith(entry)) for entry in left)


def find_problems():
    problems = []
    for name, text in pages():
        if not is_left(name, LONG_SENTENCES_LEFT):
            problems += long_sentences(name, text)
        if not is_left(name, LONG_LINES_LEFT):
            problems += long_lines(name, text)
        if not is_left(name, HEADINGS_LEFT):
            problems += headings(name, text)
    for path in repository_files(".hpp", ".cpp", ".ts", ".mjs"):
        name, text = relative(path), path.read_text(encoding="utf-8")
        problems += dangling_comments(name, text)
        if name.startswith("apps/cli/"):
            problems += help_texts(name, text)
    for path in repository_files(".py"):
        problems += dangling_python(relative(path), path.read_text(encoding="utf-8"))
    return problems


def find_faults_of_this_check():
    """Each rule finds what it is for, and leaves the rest."""
    long = "word " * MAX_WORDS
    cases = [  # rule, text, number of problems
        (long_sentences, f"{long}more.\n", 1),
        (long_sentences, f"{long.strip()}. More words.\n", 0),
        (long_sentences, f"- {long.strip()}.\n- {long.strip()}\n", 0),
        (long_sentences, f"{long}\n`{long}` [of it](http://example.org/{'a' * 99})\n", 1),
        (long_sentences, f"{long}`a b c` 1.5 x_1 = 2\n", 0),
        (long_sentences, f"```text\n{long}more\n```\n| {long}more |\n\n    {long}more\n", 0),
        (long_sentences, f"{long}e.g. this.\n", 1),
        (long_lines, "a" * (MAX_COLUMNS + 1), 1),
        (long_lines, "| " + "a" * MAX_COLUMNS, 0),
        (long_lines, f"[a]({'b' * MAX_COLUMNS})", 0),
        (long_lines, f"```text\n{'a' * (MAX_COLUMNS + 1)}\n```\n", 0),
        (long_lines, f"```sh\n{'a' * (MAX_COLUMNS + 1)}\n```\n", 1),
        (lambda _, text: long_lines("README.md", text), "| " + "a" * MAX_COLUMNS, 1),
        (headings, "# Rest shapes\n\nrest shapes\n", 1),
        (headings, "```sh\n# at rest\n```\n", 0),
        (help_texts, 'command.flag("--x", x, "count the unkn"\n "owns").group("What");\n', 1),
        (help_texts, 'command("x", "Number of threads"); // unknowns\n', 0),
        (dangling_comments, "/// Of each body the force.\n", 1),
        (dangling_comments, "/// The force\n/// Of each body.\n", 0),
        (dangling_comments, "/** What a page knows. */\ndouble a;  ///< of each body\n", 2),
        (dangling_comments, 'double a;  ///< offset of each body\nopen("http://of whom");\n', 0),
        (dangling_python, 'a = "# what"  # of it\n# What\n# what\ndef f():\n    """Of what."""\n', 3),
        (dangling_python, '"""Whatever."""\n# Often\n# of it\n', 0),
    ]
    return [
        f"{rule.__name__} on {text[:40]!r}: expected {expected} problems, got {found}"
        for rule, text, expected in cases
        if len(found := rule("docs/a.md", text)) != expected
    ]


if __name__ == "__main__":
    found = find_problems() + find_faults_of_this_check()
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))
