"""Count words of the project's own, for which the field has a standard term, in two commits: docs/terms.md.

    python tools/terms.py --page docs/terms.md [--before 54f7392] [--after HEAD]

Counted are README and the pages of docs/ with examples' comments, help texts (files of the command line), and texts in
figures (files whose names contain "pictures"). Pages that a build writes are left out.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from fabrics.files import write_whole  # noqa: E402

# {word: (pattern, standard term)}; the patterns leave out other senses where they can
TERMS = {
    "the source (of the thesis)": (
        r"\b[Tt]he source\b(?! (?:of|code|text|file))|source's\b|source thesis",
        "the thesis",
    ),
    "hangs on": (r"\bhangs? (?:on|neither|not)\b", "depends on"),
    "told, tells of": (r"\btold\b|\btells? of\b", "stated, reported"),
    "asked": (r"\basked\b(?! for)", "target, required"),
    "plates": (r"\bplates?\b", "platens"),
    "bricks": (r"\bbricks?\b", "hexahedra, solid elements"),
    "modes without energy": (r"modes without energy", "zero-energy (hourglass) modes"),
    "slaves, two passes": (r"\bslaves?\b|\btwo passes\b", "symmetric segment-to-segment contact"),
    "foot": (r"\b(?:the|its|a) foot\b(?! of the deflected)", "closest-point projection"),
    "toe of a contact": (r"(?:inside|past|over) the (?:default )?toe\b|toe over penalty", "smoothing length"),
    "snaps taut": (r"\bsnaps? taut\b", "slack-to-taut transition"),
    "march": (r"\bmarch(?:es|ed|ing)?\b", "explicit time integration"),
    "rows awake": (r"\bawake\b|\bfall asleep\b", "active zone"),
    "to the bit, change no bit": (r"\bto the bit\b|\bno bit\b|bit by bit|bit for bit", "bitwise identical"),
    "doubles": (r"\bin doubles?\b", "double precision"),
    "passages": (r"\bpassages?\b", "ply interpenetrations"),
    "held apart": (r"\bheld apart\b", "contact corrections"),
    "next but one": (r"\bnext but ones?\b", "second neighbour"),
    "torn cloth": (r"\btorn cloth\b", "failed fabric"),
    "led in": (r"\bled in\b", "pulled in"),
    "bare block": (r"\bbare block\b", "unprotected backing"),
    "jam, bunched up": (r"\bjams?\b|\bbunched up\b", "self-contact"),
    "beaten by none, none beats": (r"beaten by none|\bnone beats\b", "Pareto-optimal"),
    "dearer, dear": (r"\bdear(?:er|est)?\b", "more expensive"),
    "most exact": (r"\bmost exact\b", "lowest error"),
    "scouts": (r"\bscouts?\b", "pilot runs"),
    "promise": (r"\bpromises?\b", "tolerance"),
    "ledger": (r"\bledger\b", "table of claims, validation matrix"),
    "ways to fail": (r"\bways to fail\b", "failure modes"),
    "kink speed": (r"\bkink\b", "transverse wave"),
    "knobs": (r"\bknobs?\b", "numerical parameters"),
    "cloth": (r"\bcloth\b", "fabric"),
    "beside each other (processes)": (r"\bbeside each other\b", "in parallel"),
    "calm": (r"\bcalm\b", "stable"),
}
KINDS = ("documents", "help texts", "figures")
HEAD = """# Terms

Words of the project's own, the standard term for each, and how often they occur. Made by `{command}`; not to be edited
by hand. Before: commit {before}, the state that was reviewed. After: commit {after}. Counted are README, docs/ and the
comments of examples/ ("documents"), the files of the command line ("help texts"), and the files that draw ("figures").
Words in quoted names of keys and files count too. `tests/test_terminology.py` lists words that may not occur at all."""


def kind(name):
    """Which of KINDS a file is counted as, or None."""
    if name == "README.md" or (name.startswith("docs/") and name.endswith(".md") and name != "docs/terms.md"):
        return KINDS[0]
    if name.startswith("examples/"):
        return KINDS[0]
    if name.startswith("weavecell/") and name.endswith(".py") and re.search(r"\bcli[_/]|options\.py", name):
        return KINDS[1]
    return KINDS[2] if name.endswith(".py") and "pictures" in name and not name.startswith("tests/") else None


def texts(commit):
    """{kind: text of all its files} of a commit."""
    found = dict.fromkeys(KINDS, "")
    for name in _git("ls-tree", "-r", "--name-only", commit).splitlines():
        if kind(name):
            found[kind(name)] += "\n" + _git("show", f"{commit}:{name}")
    return found


def counts(found):
    """{word: (documents, help texts, figures)} of `texts`; lines are joined, since words are broken over them."""
    plain = {each: " ".join(text.split()) for each, text in found.items()}
    return {
        word: tuple(len(re.findall(pattern, plain[each])) for each in KINDS) for word, (pattern, _) in TERMS.items()
    }


def table(before, after):
    """The table in Markdown, with a sum."""
    rows = ["| word | standard term | " + " | ".join(f"{each}, before / after" for each in KINDS) + " |",
            "| --- | --- |" + " ---: |" * len(KINDS)]  # fmt: skip
    for word, (_, standard) in TERMS.items():
        cells = [f"{old} / {new}" for old, new in zip(before[word], after[word])]
        rows.append(f"| {word} | {standard} | " + " | ".join(cells) + " |")
    sums = [
        f"**{sum(b[k] for b in before.values())} / {sum(a[k] for a in after.values())}**" for k in range(len(KINDS))
    ]
    return "\n".join([*rows, "| all | | " + " | ".join(sums) + " |"])


def main(options):
    before, after = (_git("rev-parse", "--short=12", commit).strip() for commit in (options.before, options.after))
    made = table(*(counts(texts(commit)) for commit in (before, after)))
    print(made)
    if options.page is not None:
        command = "python tools/terms.py --page docs/terms.md"
        with write_whole(options.page) as file:
            file.write(f"{HEAD.format(command=command, before=before, after=after)}\n\n{made}\n")


def _git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", default="54f7392")
    parser.add_argument("--after", default="HEAD")
    parser.add_argument("--page", type=Path)
    main(parser.parse_args())
