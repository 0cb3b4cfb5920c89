"""What tests read of the folder that a command has written."""

import csv
import json
import re
from html import unescape


def names(folder):
    """Names of its files in one line, in their order, without hidden ones."""
    return " ".join(sorted(path.name for path in folder.glob("[!.]*")))


def table_of(folder, name="summary.json"):
    """The content of a JSON file."""
    return json.loads((folder / name).read_text())


def rows_of(folder, name):
    """The rows of a CSV file, as texts."""
    return list(csv.DictReader((folder / name).read_text("utf-8").splitlines()))


def page_of(folder, name="report.html"):
    """The HTML of a page as it is read: without marks of words that it explains."""
    return without_marks((folder / name).read_text("utf-8"))


def without_marks(page):
    """A page without <abbr>, with the characters themselves."""
    return unescape(re.sub(r"</?abbr[^>]*>", "", page))
