"""Words of the project's own, which readers from LS-DYNA, FEniCS or numpy do not know: none in code or documents.

The terms in use stand in docs/glossary.md and in CONTRIBUTING.md. "Source" is the origin of a number in a data file, or
program text; the work that the project implements is "the thesis".
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = (
    "fabrics",
    "meshing",
    "unitcell3d",
    "shellfabric",
    "weavecell",
    "validation",
    "benchmarks",
    "tools",
    "examples",
)
BANNED = {
    "told": r"\btold\b",
    "asked": r"\basked(?!_)\b",
    "hangs on": r"\bhangs?\s+on\b",
    "leaves it to": r"\bleaves? it to (?!the compiler)",
    "what is left": r"\bwhat is left\b(?! over)",
    "the source, of the thesis": r"\bsource thesis\b|\b[Tt]he\s+source's\b",
}
# texts of others
EXEMPT = {"the source, of the thesis": ("docs/errata.md",)}
# the ledger's own words for a claim are being revised with the ledger
DEFERRED = ("validation/claims/claims.toml", "validation/claims/additional.toml")


def documents(root):
    """The pages under docs/, without those that a build writes there."""
    return [path for path in (root / "docs").rglob("*.md") if not {"generated", "_build"} & set(path.parts)]


def texts(root):
    """{name: text} of the product's code, data files and templates, of README, CONTRIBUTING and docs."""
    files = [path for package in PACKAGES for path in (root / package).rglob("*")]
    files += [*root.glob("*.md"), *documents(root)]
    kinds = {".py", ".toml", ".md", ".j2"}
    names = {str(path.relative_to(root)): path for path in files if path.suffix in kinds and path.is_file()}
    return {name: path.read_text("utf-8") for name, path in names.items() if name not in (*DEFERRED, "CHANGELOG.md")}


def uses(root):
    """Each place of a banned word."""
    found = []
    for name, text in texts(root).items():
        for word, pattern in BANNED.items():
            if name in EXEMPT.get(word, ()):
                continue
            for match in re.finditer(pattern, text):
                found.append(f"{name}:{text.count(chr(10), 0, match.start()) + 1}: {match.group()!r} ({word})")
    return found


def test_no_word_of_our_own():
    assert uses(ROOT) == []


@pytest.mark.parametrize(
    "text",
    [
        "what the caller is told",
        "as asked",
        "the result hangs\non the mesh",
        "numba leaves it to the user",
        "what is left of a step",
        "in the source's form",
    ],
)
def test_each_word_is_found(tmp_path, text):
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "page.md").write_text(f"A line.\n{text}\n")
    assert [place.split(": ")[0] for place in uses(tmp_path)] == ["docs/page.md:2"]
