"""Words of the field have their explanation where they are printed: in the terminal, in a notebook, in every kind of
place of a report."""

import re
from dataclasses import replace
from html import escape, unescape

import pytest

from fabrics import assumed, catalogue
from shellfabric.membrane.quality import CHECKS
from weavecell.report.page import Figure, Report, Section, Table, render
from weavecell.report.shot.chapters_shot import OF_A_DESIGNER
from weavecell.results import glossary, keys
from weavecell.results.finding import Answer

# what a reader who knows finite elements and has never met the field asks about
JARGON = (
    *("failure length", "Lambert-Jonas", "windowing", "viscous energy", "doubtful", "noted"),
    *("recoil of cut yarns", "failure dissipation", "energy error", "strike energy", "crimp"),
    *("critical velocity", "residual velocity", "mixed outcomes", "V50", "V100", "probit", "logit"),
    *("Weibull shape", "areal density", "crossover", "resolved yarns", "strength after weaving"),
    *("back-face signature", "denier", "dtex", "rms", "E_c", "rho_f", "limit without scatter"),
)
PLACES = (
    *("answer", "over", "lead", "caption of a figure", "point", "caption", "heading", "cell"),
)


def page_with(place, text):
    """A page that has a text in a place, and other words in all others."""
    texts = {each: f"other {number}" for number, each in enumerate(PLACES)} | {place: text}
    tables = (Table((texts["heading"], "value"), ((texts["cell"], "1"),), texts["caption"]),)
    figure = Figure(b"<svg/>", "svg", texts["caption of a figure"], "name")
    section = Section("one", "One", texts["lead"], (figure,), tables, (texts["point"],))
    answer = Answer("A", texts["answer"], over=texts["over"])
    return render(Report(answer, "B", (section,)))


def explained_in(html):
    """{word as printed: its explanation} of the marks of a page."""
    found = re.findall(r'<abbr title="([^"]*)">([^<]*)</abbr>', html)
    return {unescape(word): unescape(means) for means, word in found}


@pytest.mark.parametrize("place", PLACES)
def test_every_word_is_explained_in_every_place_of_a_report(place):
    text = "; ".join(f"5 < 7 & {word} of 3" for word in glossary.words())
    html = page_with(place, text)
    assert explained_in(html) == glossary.words()
    # the text is what it was
    assert text in unescape(re.sub(r"<[^>]*>", "", html))
    assert html.count('id="words"') == 1
    html = html.partition('id="words"')[2]
    assert set(re.findall(r"<dt>(.*?)</dt>", html)) == set(glossary.words())


def test_a_word_is_explained_once_in_each_section():
    """In the section that a reader has opened, not in all its places."""
    sections = []
    for name in ("one", "two", "three"):
        table = Table(("V50 of A", "V50"), (("V50", "1"),), "V50 and V50")
        sections.append(Section(name, name, "V50, then V50", (), (table,)))
    html = render(Report(Answer("A", "5"), "B", tuple(sections)))
    means = glossary.words()["V50"]
    assert html.count(f'<abbr title="{escape(means)}">V50</abbr>') == len(sections)


def test_a_page_without_such_words_has_no_list():
    html = page_with("cell", "steel")
    assert 'id="words"' not in html
    assert not explained_in(html)


def labels():
    """Texts that tables print: of result files, checks, results of a designer, assumptions."""
    for table in keys.TABLES.values():
        yield from (key.label for key in table)
        yield from (key.meaning for key in table)
    yield from OF_A_DESIGNER.values()
    for check in CHECKS.values():
        yield from (check.name, check.meaning, check.advice)
    for name in ("S-720", "S-728", "S-731"):
        yield from assumed.lines(catalogue.load(name))


@pytest.mark.parametrize("word", JARGON)
def test_labels_with_jargon_have_its_explanation(word):
    """In lower case, with a capital and with an s, wherever a label has it."""
    assert word in glossary.words()
    texts = [text for text in labels() if re.search(rf"(?<![\w-]){word}s?(?!\w)", text)]
    texts += [word, f"({word}s)", f"{word}, {word}", f"{word[0].upper()}{word[1:]} 3"]
    if word.islower():
        texts.append(f"{word.upper()}: 3")
    for text in texts:
        means = glossary.explain(text)
        # a longer word may hold it
        assert word in means or any(word in longer for longer in means), text
        marked = glossary.mark(text)
        assert "<abbr" in marked
        assert unescape(re.sub(r"<[^>]*>", "", marked)) == text


def test_terminal_has_a_line_for_each_word_and_each_check():
    checks = [
        replace(check.judge(factor * (check.limit or 1.0)), note=None)
        for check, factor in zip(CHECKS.values(), [0.5, 2.0] * len(CHECKS))
    ]
    text = "; ".join(("windowing", "Failure length 3 mm", *map(str, checks)))
    lines = glossary.lines(text, checks)
    for check in checks:
        line = f"  {check.name}: {check.meaning}"
        assert lines.count(line) == (0 if check.ok else 1)
    assert sum(line.startswith("  windowing: ") for line in lines) == 1
    assert sum(line.startswith("  failure length: ") for line in lines) == 1
    names = [line.partition(":")[0] for line in lines]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    "text", ["uncrimped-V500", "xV50", "V5012", "doubtfully", "E_cd", "steel", "warp.E_c"]
)
def test_parts_of_other_words_stay_as_they_are(text):
    assert glossary.mark(text) == text
    assert not glossary.explain(text)


def test_explanations_are_short_and_do_not_use_their_own_word():
    for word, means in glossary.words().items():
        assert len(means) < 160, word
        assert word not in means
        assert not means.endswith(".")
