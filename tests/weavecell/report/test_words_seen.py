"""What a reader of a page sees before anything is unfolded: few words, in short sentences."""

import re
from html.parser import HTMLParser

import pytest

from tests.weavecell.session_runs import RUNS
from weavecell.report.page import Report, Section, Table, render
from weavecell.results.finding import Answer

PAGES = [name for name, run in RUNS.items() if "report.html" in run["folder"].split()]
MOST_WORDS = 800
LONGEST = 25  # words of a sentence, beside numbers and their units
NO_CLOSING = {"img", "meta", "br", "input", "link", "hr"}
TEXT = "p li td th h1 h2 h3 figcaption caption summary dt dd div a pre button option label footer section"
BLOCKS = {*TEXT.split(), "script", "style", "details", "table", "title"}


class Blocks(HTMLParser):
    """Texts of a page: (text, whether it is folded, whether it stands in a table or is verbatim)."""

    def __init__(self, page):
        super().__init__()
        self.open, self.text, self.found = [], [], []
        self.feed(page)
        self.flush()

    def flush(self):
        text = " ".join("".join(self.text).split())
        self.text = []
        heading = "summary" in self.open and self.open.count("details") == 1
        folded = "details" in self.open and not heading
        if text and not {"script", "style", "title"} & set(self.open):
            in_table = "table" in self.open and "caption" not in self.open
            self.found.append((text, folded, in_table or "pre" in self.open))

    def handle_starttag(self, tag, attrs):
        if tag in NO_CLOSING:
            return
        if tag in BLOCKS:
            self.flush()
        self.open.append(tag)

    def handle_endtag(self, tag):
        if tag in NO_CLOSING or tag not in self.open:
            return
        if tag in BLOCKS:
            self.flush()
        while self.open.pop() != tag:
            pass

    def handle_data(self, data):
        self.text.append(data)


def seen(page):
    """Texts outside of what is folded, and those of them outside of tables."""
    blocks = [block for block in Blocks(page).found if not block[1]]
    return [text for text, *_ in blocks], [text for text, _, table in blocks if not table]


def test_words_of_a_page_are_counted():
    folded = "<details><summary>seen</summary><p>not seen</p></details>"
    page = f"<title>no</title><h1>A b</h1>{folded}<table><td>1234</td></table>"
    assert seen(page) == (["A b", "seen", "1234"], ["A b", "seen"])


@pytest.mark.parametrize("name", PAGES)
def test_a_page_shows_few_words(results, name):
    page = (results(name).folder / "report.html").read_text("utf-8")
    texts, prose = seen(page)
    assert sum(len(text.split()) for text in texts) <= MOST_WORDS
    long = [
        sentence
        for text in prose
        for sentence in re.split(r"(?<=[.!?;:])\s+", text)
        if len(re.findall(r"[^\W\d_]{2,}", sentence)) > LONGEST
    ]
    assert long == []


@pytest.mark.parametrize(
    ("texts", "numbers", "shown"),
    [(1, 2, "values"), (2, 4, "tight"), (4, 0, "stacked"), (1, 7, "stacked"), (1, 12, "stacked")],
)
def test_a_table_of_many_columns_is_a_list_on_a_phone(texts, numbers, shown):
    """Twelve columns of plies stood 180 px beyond a page of 390."""
    names = [f"c{n}" for n in range(texts + numbers)]
    table = Table(tuple(names), (tuple(names),), numeric=tuple(names[texts:]))
    page = render(Report(Answer("A", "B"), "C", (Section("one", "One", tables=(table,)),)))
    assert f'<table class="{shown}">' in page
