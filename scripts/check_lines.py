#!/usr/bin/env python3
"""Checks how long lines are: at most 100 characters in C++ and Markdown, 120 in Python and shell scripts.

    scripts/check_lines.py [ROOT]       prints each line that is too long; exit code 1 when there is one
    scripts/check_lines.py --self-test  plants long lines and sees that each is found

Three things in Markdown may be longer: tables, code blocks, and a single link, picture or piece of code that cannot
be broken. Pages that scripts/docs.sh writes come from the help texts, and are not checked.
"""
import pathlib
import re
import sys
import tempfile

LIMITS = {".h": 100, ".cpp": 100, ".md": 100, ".py": 120, ".sh": 120}
FOLDERS = ("apps", "docs", "libdem", "scripts", "testdata", "tests")  # and the files beside them

GENERATED = "<!-- Written by scripts/docs.sh"
MARK = re.compile(r"\s*(?:(?:[-*]|\d+\.|#+)\s+)?")  # of a list or heading
UNBREAKABLE = re.compile(r"(?:!?\[[^\]]*\]\([^)]*\)|`[^`]*`|\S+)[.,:;]?")


def markdown_prose(lines):
    """The numbers and texts of the lines that the limit holds for."""
    if lines and lines[0].startswith(GENERATED):
        return
    fence = False
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("```"):
            fence = not fence
            continue
        whole = fence or line.startswith(("|", "    ")) or UNBREAKABLE.fullmatch(MARK.sub("", line, count=1))
        if not whole:
            yield number, line


def violations(root):
    """All lines below `root` that are too long, one line of text each."""
    files = [f for f in root.iterdir() if f.is_file()]
    files += [f for folder in FOLDERS for f in (root / folder).rglob("*")]
    found = []
    for file in sorted(f for f in files if f.suffix in LIMITS):
        lines = file.read_text(encoding="utf-8").split("\n")
        limit = LIMITS[file.suffix]
        for number, line in markdown_prose(lines) if file.suffix == ".md" else enumerate(lines, 1):
            if len(line) > limit:
                found.append(f"{file.relative_to(root)}:{number}: {len(line)} characters; must be at most {limit}")
    return found


def self_test():
    """Each planted line must be found, and each allowed one must pass."""
    words, long_word = "word " * 20 + "word", "w" * 101
    planted = [("a.md", f"{words}\n"), ("docs/a.md", f"- {words}\n"), ("docs/b.md", f"```\n```\n{words}\n"),
               ("docs/c.md", f"`{long_word}` and more\n"), ("libdem/a.h", f"// {words}\n"),
               ("tests/a.cpp", f"f();  // {words}\n"), ("scripts/a.sh", f"# {words} {words}\n"),
               ("apps/a.py", f"# {words} {words}\n")]
    allowed = [("a.md", f"| {words} |\n"), ("docs/a.md", f"```sh\n{words}\n```\n"), ("docs/b.md", f"    {words}\n"),
               ("docs/c.md", f"- [{words}]({long_word}).\n"), ("docs/d.md", f"![{words}]({long_word})\n"),
               ("docs/e.md", f"`{words}`\n"), ("docs/f.md", f"{GENERATED} -->\n{words}\n"),
               ("docs/g.md", f"{'é' * 100}\n"), ("scripts/a.py", f"# {words}\n"), ("build/a.h", f"// {words}\n")]
    for cases, count in (planted, 1), (allowed, 0):
        for path, text in cases:
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
                found = violations(pathlib.Path(folder))
                if len(found) != count:
                    sys.exit(f"self-test: {path} with {text!r}: {found}; must be {count} violations")
    print(f"self-test: {len(planted)} planted lines found, {len(allowed)} allowed ones passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found = violations(pathlib.Path(sys.argv[1]) if sys.argv[1:] else pathlib.Path(__file__).parents[1])
    if found:
        sys.exit("\n".join(found))
    print("no line is too long")


if __name__ == "__main__":
    main()
