"""What can be checked of the documentation without running anything: links, citations, names.

    python3 tests/docs_pages.py SOURCE        prints what is wrong; 1 when something is

tests/docs_test.py runs the same checks, and every command line.
"""

import os
import pathlib
import re
import sys

MOST_WORDS = 1000  # of the README
CODE = ("core", "formats", "baker", "tests")
SKIPPED = {".git", ".venv", ".cache", "out", "__pycache__"}
YEAR = r"(?:18|19|20)\d\d"
KEY = re.compile(rf"([A-Z][\w-]+(?:,? (?:and |& )?[A-Z][\w-]+)*) ({YEAR}(?:, {YEAR})*)")
YEARLESS = re.compile(r"^[^\n]*?//[^\n]*\[([A-Z][a-z]+(?:,? (?:and |& )?[A-Z][a-z]+)*)\](?!\()", re.M)


def markdown_pages(source):
    """All .md files of the tree, the README first."""
    pages = []
    for folder, folders, files in os.walk(source):
        folders[:] = sorted(f for f in folders if f not in SKIPPED and not f.startswith("build"))
        pages += [pathlib.Path(folder) / f for f in sorted(files) if f.endswith(".md")]
    return sorted(pages, key=lambda p: (p != source / "README.md", str(p)))


def without_code(text):
    """Fenced blocks and code spans blanked, lines and columns as they were."""
    text = re.sub(
        r"^(```\w*\n)(.*?)(^```$)",
        lambda m: m[1] + re.sub(r"[^\n]", " ", m[2]) + m[3],
        text,
        flags=re.M | re.S,
    )
    return re.sub(r"`[^`\n]*`", lambda m: " " * len(m[0]), text)


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def anchors(text):
    """Names that GitHub gives the headings of a page."""
    names, seen = set(), {}
    for heading in re.findall(
        r"^#{1,6} (.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S), re.M
    ):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        names.add(slug if slug not in seen else f"{slug}-{seen[slug]}")
        seen[slug] = seen.get(slug, 0) + 1
    return names


def wrong_links(page, text):
    """(line, what) of links and pictures that lead nowhere."""
    wrong = []
    plain = without_code(text)
    for link in re.finditer(r"\]\(([^()\s]+)\)|\bsrc=\"([^\"]+)\"", plain):
        target = link[1] or link[2]
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        path = page.parent / file if file else page
        if not path.exists():
            wrong.append((line_of(text, link.start()), f"{target}: there is no such file"))
        elif anchor and anchor not in anchors(path.read_text()):
            wrong.append((line_of(text, link.start()), f"{target}: that page has no such heading"))
    if "![](" in plain:
        wrong.append(
            (
                line_of(text, plain.index("![](")),
                "a picture without a text for those who cannot see it",
            )
        )
    return wrong


def cited_keys(text):
    """(line, key, names for it that an entry may have) of every citation in brackets.

    A key may run on in the next line of a comment.
    """
    joined = re.sub(r"\n[ \t]*(?:///?|#|\*)?[ \t]*", lambda m: " " + "\0" * (len(m[0]) - 1), text)
    for bracket in re.finditer(r"\[([^\[\]]*)\]", joined):
        for found in KEY.finditer(bracket[1].replace("\0", "")):
            names = re.split(r",? (?:and |& )?", found[1])
            for year in found[2].split(", "):
                yield line_of(text, bracket.start()), f"{found[1]} {year}", {
                    f"{found[1]} {year}",
                    f"{names[-1]} {year}",
                    f"{names[0]} {year}",
                }


def yearless_keys(text):
    """(line, key) of every name in brackets, in a comment of C++, that has no year."""
    return [(line_of(text, found.start(1)), found[1]) for found in YEARLESS.finditer(text)]


def source_files(source):
    for top in CODE + ("presets", "docs"):
        for path in sorted((source / top).rglob("*")):
            if (
                path.suffix in (".h", ".cpp", ".py", ".toml", ".md")
                and not SKIPPED & set(path.parts)
                and path.name != "bibliography.md"
            ):
                yield path
    yield from (p for p in source.glob("*.md"))


def wrong_citations(source):
    """Keys without an entry in docs/bibliography.md, and entries that nobody cites.

    An entry without a year is an abbreviation; presets write it without brackets.
    """
    entries = set(
        re.findall(r"^- \*\*\[([^\]]+)\]\*\*", (source / "docs/bibliography.md").read_text(), re.M)
    )
    wrong, used = [], set()
    for path in source_files(source):
        text = path.read_text(errors="replace")
        used |= {e for e in entries if e.isupper() and re.search(rf"\b{e}\b", text)}
        if path.suffix in (".h", ".cpp"):
            wrong += [
                (f"{path.relative_to(source)}:{line}", f"[{key}] is a citation without a year")
                for line, key in yearless_keys(text)
            ]
        for line, key, names in cited_keys(text):
            used |= entries & names
            if not entries & names:
                wrong.append(
                    (
                        f"{path.relative_to(source)}:{line}",
                        f"[{key}] has no entry in docs/bibliography.md",
                    )
                )
    return wrong + [
        ("docs/bibliography.md", f"[{entry}] is cited nowhere") for entry in sorted(entries - used)
    ]


def wrong_names(source, pages):
    """Files that pages name in code spans, and names of the code in the glossary."""
    wrong = []
    for page in pages:
        text = page.read_text()
        for span in re.finditer(
            rf"`((?:{'|'.join(CODE)}|docs|samples|cmake|presets)/[\w./-]+)`", text
        ):
            if not (source / span[1]).exists() and not list(source.glob(span[1] + ".*")):
                wrong.append(
                    (
                        f"{page.relative_to(source)}:{line_of(text, span.start())}",
                        f"{span[1]}: there is no such file",
                    )
                )
    code = [
        p
        for p in source_files(source)
        if p.suffix in (".h", ".cpp") and p.relative_to(source).parts[0] != "tests"
    ]
    words = set().union(*(set(re.findall(r"\w+", p.read_text())) | {p.stem} for p in code))
    glossary = (source / "docs/glossary.md").read_text()
    for row in re.finditer(r"^\|.*\|.*\|([^|]*)\|$", glossary.replace("\\|", "/"), re.M):
        for name in re.findall(r"`([^`]+)`", row[1]):
            missing = [part for part in name.split("::") if part not in words]
            if missing:
                wrong.append(
                    (
                        f"docs/glossary.md:{line_of(glossary, row.start())}",
                        f"{name}: the code has no {missing[0]}",
                    )
                )
    return wrong


def faults(source):
    """(place, what) of everything that is wrong."""
    pages = markdown_pages(source)
    wrong = []
    for page in pages:
        wrong += [
            (f"{page.relative_to(source)}:{line}", what)
            for line, what in wrong_links(page, page.read_text())
        ]
    wrong += wrong_citations(source)
    if (source / "core/animation").is_dir():  # the pages name the code as it is laid out in rooms
        wrong += wrong_names(source, pages)
    words = len((source / "README.md").read_text().split())
    if words > MOST_WORDS:
        wrong.append(("README.md", f"{words} words, more than {MOST_WORDS}"))
    return wrong


if __name__ == "__main__":
    found = faults(pathlib.Path(sys.argv[1]).resolve())
    for place, what in found:
        print(f"WRONG  {place}: {what}")
    sys.exit(len(found) > 0)
