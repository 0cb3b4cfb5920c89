"""Numbers on pages of docs that were written by hand, by page and kind; and the words of README and docs.

    python tools/page_numbers.py [--list PAGE] [--write]

    table, prose   results: nothing says when they are old
    test           its sentence, or the heading of its column, names a test, a measurement or another source
    input          stands with the same unit in an input of the project: studies, fabrics, examples
    count          a small whole number in prose
    label          in the heading or the first cell of a table's row

tests/test_pages.py compares the counts of results with docs/numbers.csv, which --write makes of the pages as
they are: a page may only get fewer. It holds the words below `MOST_WORDS`. Comments are not counted.
"""

from __future__ import annotations

import argparse
import csv
import re
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

import page_values  # noqa: E402

NUMBER = r"(?<![\w.,/#-])[-+−]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?(?![\w]*[A-Za-z]\d|[\d])"
TOKEN = re.compile(
    rf"(?P<n>{NUMBER})(?P<u>\s?(?:%|°|degrees|µs|us|ns|ms|s|mm|m/s|m²|kg/m³|g/m²|µm|um|m|N|J|GPa|MPa|Pa|kg|g|times|plies|dtex|den)(?![\w/²]))?"
)
GONE = [
    re.compile(p, re.S | re.M)
    for p in (
        r"<!-- (?P<name>[^\n]*?) of tools/pages\.py -->.*?<!-- end of (?P=name) -->",
        r"<!-- (?:=|rows) .*?-->.*?<!-- / -->",
        r"^```.*?^```",
        r"<!--.*?-->",
        r"\$\$.*?\$\$",
        r"\$[^$\n]+\$",
        r"`(?![\d.]+ ?%?`)[^`\n]+`",  # but a number is one in backticks too
        r"\]\([^)]*\)",
        r"https?://\S+",
    )
]
# what has digits and is no number
NAMES = re.compile(
    "|".join(
        (
            r"\b(?:S-\d+|Kevlar(?:®)? \d+(?: [A-Z]\d+)?|IM7|T300|K\d+|42 ?CrMo ?4)\b",
            r"\b(?:LAW ?\d+|FORM ?\d+|MAT_?\d+|E-\d+|V50|V0|[123]D|R[²2]|npz|UTF-8|x86-64)\b",
            r"\b(?:Python|numba|OpenRadioss|Debian) \d[\d.]*",
            r"\b(?:ASME V&V|ISO|ASTM|MIL|NIJ|STANAG)[ -][\w.-]+|\b0/45/0/45\b|\b0/90\b",
            r"\b10\.\d{4,}/[\w.()/-]+",
            r"\b(?:[Ff]ig(?:ure|s?\.|ures)?|[Ss]ections?|[Tt]ables?|[Cc]hapters?|[Ee]q(?:uations?|s?\.)"
            r"|[Aa]pp(?:endix|\.)|pages?|p\.|pp\.|Vol\.|No\.|rows?|cases?|step|zone|type|errat(?:um|a)"
            r"|commit|version|seed) (?:[A-Z]?-?\d[\w.-]*(?:(?:, | and | to )[A-Z]?-?\d[\w.-]*)*)",
            r"\b(?:19|20)\d\d(?:-\d\d(?:-\d\d)?)?\b",
            r"\b1/[a-zA-Z]+\b|\b\d+(?: x \d+)+(?![.\d])(?: m?m\b)?"  # panels and meshes are set up
            r"|\btargets?(?: of| is| below)? \d[\d.]*"
            r"|\bfriction (?:of |between |on the nose |yarns |plies )*\d[\d.]*(?: (?:to|and) \d[\d.]*)?"
            r"|\b\d+ \(\d{4}\) \d+|\b\d+, \d+-\d+\b|\bRes\. J\. \d+,\s*\d+|^\s*\d+\. |\b[A-Z][a-z]+-\d+\b",
        )
    ),
    re.MULTILINE,
)
MEASURED = re.compile(
    r"\btests?\b|measured|published|thesis|data sheet|Abaqus|DynELA|OpenRadioss|LS-DYNA|literature|regression",
    re.I,
)


def plain(match):
    """Blank what is no number, and keep its lines."""
    return re.sub(r"[^\n]", " ", match[0])


def cleaned(text):
    """Blank marks, code, formulas, links and names."""
    for pattern in GONE:
        text = pattern.sub(plain, text)
    return NAMES.sub(plain, text)


def inputs():
    """Collect the numbers of input files, {(number, unit)}."""
    found = set()
    files = [
        *(ROOT / "validation" / "studies").glob("*.toml"),
        *(ROOT / "validation" / "measured" / "inputs").rglob("*.toml"),
        *(ROOT / "examples").rglob("*.toml"),
        *(ROOT / "fabrics").rglob("*.toml"),
        *(ROOT / "shellfabric").rglob("*.toml"),
        *(ROOT / "weavecell" / "scenes").glob("*.toml"),
    ]
    for file in files:
        text = re.sub(r"#.*", "", file.read_text("utf-8"))
        for word, unit in re.findall(
            r"(?<![\w.])(\d+(?:\.\d+)?) ?(%|°|deg|us|µs|ns|ms|mm|m/s|um|µm|m|N|J|GPa|MPa|Pa|kg|g|dtex|den|s)?(?![\w])",
            text,
        ):
            found.add((float(word), {"us": "µs", "um": "µm", "deg": "°"}.get(unit, unit)))
    return found


def of_page(path):
    """List the numbers of a page: [(kind, line, number, unit, text of the line)]."""
    text = path.read_text("utf-8")
    clean = cleaned(text)
    found = []
    for match in TOKEN.finditer(clean):
        word = match["n"]
        try:
            value = float(word.lstrip("-+−").replace(",", ""))
        except ValueError:
            continue
        line = clean[clean.rfind("\n", 0, match.start()) + 1 : clean.find("\n", match.end())]
        in_table = line.lstrip().startswith("|")
        unit = (match["u"] or "").strip()
        known = {"us": "µs", "um": "µm", "degrees": "°", "plies": ""}.get(unit, unit)
        counted = unit in ("plies", "times") or not (unit or in_table)
        if in_table and is_label(clean, match):
            kind = "label"
        elif counted and value <= 20 and value.is_integer():
            kind = "count"
        elif unit and (value, known) in INPUTS:
            kind = "input"
        elif path == ERRATA or MEASURED.search(context(clean, match, in_table)):
            kind = "test"
        elif in_table:
            kind = "table"
        else:
            kind = "prose"
        row = text.count("\n", 0, match.start()) + 1
        found.append((kind, row, word, unit, " ".join(line.split())[:110]))
    return found


def is_label(text, match):
    """Say whether a number of a table stands in its heading or in the first cell of its row."""
    begin = text.rfind("\n", 0, match.start()) + 1
    end = text.find("\n", match.end())
    heading = re.match(r"\|[ :|-]+$", text[end + 1 :].partition("\n")[0])
    return heading is not None or text.count("|", begin, match.start()) == 1


def context(text, match, in_table):
    """Return what says where a number comes from: its sentence, or its row with the heading of its column."""
    if in_table:
        return f"{column_heading(text, match)}\n{sentence(text, match)}"
    return sentence(text, match)


def column_heading(text, match):
    """Return the heading of the column of a table in which a number stands."""
    begin = text.rfind("\n", 0, match.start()) + 1
    column = text.count("|", begin, match.start())
    rows = []
    for line in reversed(text[:begin].splitlines()):
        if not line.lstrip().startswith("|"):
            break
        rows.append(line)
    return rows[-1].split("|")[column]


def sentence(text, match):
    """Return the sentence or the row of a table that holds a number."""
    a = max(
        text.rfind(". ", 0, match.start()),
        text.rfind("\n\n", 0, match.start()),
        text.rfind("\n|", 0, match.start()),
    )
    ends = [
        e
        for e in (
            text.find(". ", match.end()),
            text.find("\n\n", match.end()),
            text.find("\n|", match.end()),
        )
        if e > 0
    ]
    return text[a + 1 : min(ends, default=len(text))]


INPUTS = inputs()
ERRATA = ROOT / "validation" / "reports" / "errata.md"  # all numbers are the thesis's
ALLOWED = ROOT / "docs" / "numbers.csv"
MOST_WORDS = 60_000


def counted():
    """Count the results by hand of each page that has any: {page: number}."""
    found = {}
    for page in page_values.written():
        kinds = Counter(kind for kind, *_ in of_page(page))
        results = kinds["table"] + kinds["prose"]
        if results:
            found[str(page.relative_to(ROOT))] = results
    return found


def words():
    """Count the words of each page of README and docs that git keeps, made from code or not."""
    pages = [*page_values.written(), *(ROOT / "docs" / "generated").glob("*.md")]
    seen = {page: re.sub(r"<!--.*?-->", "", page.read_text("utf-8"), flags=re.S) for page in pages}
    return {
        str(page.relative_to(ROOT)): len(text.split())
        for page, text in seen.items()
        if "validation" not in page.relative_to(ROOT).parts
    }


def allowed():
    """Read how many results by hand each page may have."""
    with open(ALLOWED, encoding="utf-8", newline="") as file:
        return {row["page"]: int(row["results by hand"]) for row in csv.DictReader(file)}


def main():
    """Run the command line."""
    parser = argparse.ArgumentParser(description="Numbers on pages that were written by hand.")
    parser.add_argument("--list", metavar="PAGE", help="list those of a page, with their kinds")
    parser.add_argument("--write", action="store_true", help="keep the counts in docs/numbers.csv")
    options = parser.parse_args()
    if options.list:
        for one in of_page(ROOT / options.list):
            print(*one, sep="\t")
        return
    counts = counted()
    if options.write:
        lines = [f"{name},{number}\n" for name, number in counts.items()]
        ALLOWED.write_text("page,results by hand\n" + "".join(lines), "utf-8")
    sizes = words()
    for name in {**sizes, **counts}:
        print(f"{counts.get(name, 0):5} results {sizes.get(name, 0):7} words  {name}")
    print(f"{sum(counts.values()):5} results {sum(sizes.values()):7} words")


if __name__ == "__main__":
    main()
