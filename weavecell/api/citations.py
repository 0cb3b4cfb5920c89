"""What a result, or a run that an input file describes, is to cite."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

from fabrics import __version__, catalogue, references
from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import read_toml
from fabrics.fabric import Fabric
from weavecell.answers.result import Result
from weavecell.api.entrance import public
from weavecell.api.target import is_input_file, read_target, resolve_target, unknown_target
from weavecell.results import provenance, sources
from weavecell.results.result_folder import KINDS, open_folder
from weavecell.results.sources import Source
from weavecell.scenes import build
from weavecell.scenes import coupon as coupons
from weavecell.scenes.fabric_table import check_scene

if TYPE_CHECKING:
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup

# what computes a result, by its JSON file; a panel of any other
_USES = {
    "law.json": ("crossover",),
    "surface.json": ("crossover",),
    "case.json": ("crossover",),
    "mesh.json": ("mesh",),
}
THESIS = "thesis2006"  # in references.toml
_FITTED_BY = "3D crossover"
# a number of these statuses is what somebody published or sold, whether it is known to us or not
_OF_OTHERS = ("measured", "published", "second-hand", "nominal", "corrected", "user")
_MOST = 4  # numbers of a fabric that are named one by one
_WIDTH = 96
# as in CITATION.cff, which no installation has
TITLE = (
    "weavecell: woven ballistic fabrics under impact, from yarn and weave data and assumed or fitted "
    "laws"
)


@explain_frozen
@dataclass(frozen=True)
class Citations:
    """What is to be cited; its text is BibTeX.

    Parameters
    ----------
    name : of the file, folder or fabric
    sources : of every number
    uses : what computed it: "panel", "crossover", "mesh", "picture"
    versions : {program: version}

    Examples
    --------
    >>> print(wc.cite("S-720").to_bibtex().partition("{")[0])
    @software
    """

    name: str
    sources: tuple[Source, ...]
    uses: tuple[str, ...]
    versions: Mapping[str, str]

    def to_dataframe(self) -> DataFrame:
        """Return a table with a row for each number: status, keys of BibTeX, source."""
        from pandas import DataFrame

        rows = []
        for of, number, status, text in self.sources:
            keys = ", ".join(each.key for each in references.find_cited(text))
            rows.append((of, number, status, keys, text))
        columns = ["of", "number", "status", "cited", "source"]
        return DataFrame(rows, columns=columns).set_index(["of", "number"])

    def to_bibtex(self) -> str:
        """Write the entries of BibTeX: weavecell, publications, sources of other texts, programs."""
        entries = [self._weavecell()]
        for each in references.list_references():
            named = [source for source in self.sources if each.is_named_in(source.text)]
            if each.key == THESIS:
                entries.append(each.to_bibtex(f"Used for the model; {join_numbers(named)}"))
            elif named:
                entries.append(each.to_bibtex(f"Used for {join_numbers(named)}"))
        for k, (text, named) in enumerate(self._of_others().items(), 1):
            note = f"Used for {join_numbers(named)}"
            fields = {"title": references.escape(text)}
            entries.append(
                references.Reference(
                    f"source{k}", "misc", fields, checked="the source of the number itself"
                ).to_bibtex(note)
            )
        for each in references.list_programs(*self.uses):
            version = self.versions.get(each.key)
            entries.append(each.to_bibtex(f"Version {version}" if version else ""))
        return "\n\n".join(entries)

    def _weavecell(self) -> str:
        fields = {
            "author": "{The weavecell developers}",
            "title": TITLE,
            "version": self.versions.get("weavecell", __version__),
        }
        return references.Reference("weavecell", "software", fields, checked="itself").to_bibtex()

    def _of_others(self) -> dict[str, list[Source]]:
        """{text: its sources} of what others published, and no entry of references.toml is."""
        found: dict[str, list[Source]] = {}
        for source in self.sources:
            cited = references.find_cited(source.text)
            if source.status in _OF_OTHERS and source.text and not cited:
                found.setdefault(source.text, []).append(source)
        return found

    def _without_publication(self) -> dict[str, list[Source]]:
        """{status and text: its sources} of assumptions, and of what follows from other numbers."""
        found: dict[str, list[Source]] = {}
        for source in self.sources:
            if source.status not in _OF_OTHERS and not references.find_cited(source.text):
                found.setdefault(f"{source.status}: {source.text}", []).append(source)
        return found

    def __repr__(self) -> str:
        entries = self.to_bibtex().count("\n@") + 1
        return f"Citations({self.name}: {entries} BibTeX entries, {len(self.sources)} numbers; print shows all)"

    def _repr_html_(self) -> str:
        return f"<pre style='white-space: pre-wrap'>{escape(str(self))}</pre>"

    def __str__(self) -> str:
        heading = [f"What {self.name} rests on, as BibTeX"]
        if unpublished := self._without_publication():
            heading.append("Numbers without a publication:")
        for text, named in unpublished.items():
            heading.append(f"{join_numbers(named)}, {text}")
        # BibTeX skips what stands between entries, up to the next @
        lines = [
            fill(line.replace("@", "(at)"), _WIDTH, initial_indent="% ", subsequent_indent="%   ")
            for line in heading
        ]
        return "\n".join(lines) + "\n\n" + self.to_bibtex()


def join_numbers(named: Iterable[Source]) -> str:
    """Write the numbers of sources as a list; of a fabric with many, those of their tables."""
    grouped: dict[str, list[str]] = {}
    for source in named:
        numbers = grouped.setdefault(source.of, [])
        if source.number not in numbers:
            numbers.append(source.number)
    parts = []
    for of, numbers in grouped.items():
        if len(numbers) > _MOST:
            numbers = list(dict.fromkeys(number.partition(".")[0] for number in numbers))
        parts.append(f"{', '.join(numbers)} of {of}")
    return "; ".join(parts)


@public
def cite(
    target: Fabric | FilePath | Result | ImpactSetup, *, out: FilePath | None = None
) -> Citations:
    """List what a result is to cite, as BibTeX: weavecell, the thesis, the source of every number
    that it used, and the programs that computed it.

    Numbers without a publication, such as assumptions, are named in comments above the entries.

    Parameters
    ----------
    target : folder of results, input file, fabric file, or name of a fabric; in Python also a
        result, a Fabric, or a set-up of `setup`
    out : also write it to this .bib file; never over one that exists

    Raises
    ------
    InputError : nothing of this name, a folder without results, or `out` exists

    Examples
    --------
    >>> wc.cite("S-720").to_dataframe()["cited"]["S-720", "warp.crimp"]
    'thesis2006'
    """
    path = None
    if out is not None:
        path = Path(out)
        if path.suffix != ".bib":
            raise InputError(key="out", value=str(out), allowed="a path that ends in .bib")
        files.refuse_existing(path)
    found = _find(target)
    if path is not None:
        files.write(path, f"{found}\n")
    return found


def _find(target):
    """The Citations of any target."""
    if isinstance(target, (str, os.PathLike)):
        if Path(target).is_dir():
            return _of_folder(Path(target))
        return _of_input(str(target))
    if isinstance(target, Result):
        if target.folder is not None:
            return _of_folder(target.folder)
        return _of_result(target)
    if isinstance(target, Fabric):
        rows = tuple(sources.list_sources((target,), target.laws or (), ""))
        return _of_panel(target.name, rows)
    panel = resolve_target(target, {}, "shot")
    return _of_panel(panel.title, _sources_of(panel.setup, panel.text))


def _of_result(result):
    """What a result that stands in no folder rests on: its target or targets, or its fabric."""
    panels = getattr(result, "targets", None) or [getattr(result, "target", None)]
    rows = []
    for panel in filter(None, panels):
        rows += _sources_of(panel.setup, panel.text)
    fabric = getattr(result, "fabric", None)
    if not rows and fabric is not None:
        rows = sources.list_sources((fabric,), fabric.laws or (), "")
    name = getattr(result, "title", type(result).__name__)
    found = tuple(dict.fromkeys(rows))
    return Citations(
        name, found, _with_laws((*result.uses, "picture"), found), provenance.versions()
    )


def _sources_of(setup, text):
    """The sources of a set-up and of the input file that it was read from."""
    laws = [law for ply in setup.lay_up or (setup,) for law in ply.laws or ()]
    return tuple(sources.list_sources(setup.fabrics, laws, text))


def _of_panel(name, rows):
    uses = _with_laws(("panel", "picture"), rows)
    return Citations(name, rows, uses, provenance.versions())


def _of_folder(folder: Path) -> Citations:
    """Read what a run recorded of its sources and versions."""
    found = open_folder(folder)
    for name in (*KINDS, "provenance.json"):
        if not found.has(name):
            continue
        content = found.read_json(name)
        stamp = content.get("provenance", content)
        if isinstance(stamp, dict) and isinstance(stamp.get("sources"), list):
            rows = tuple(Source(*row) for row in stamp["sources"])
            pairs = [pair.partition(" ") for pair in stamp["packages"].split(", ")]
            versions = {program: version for program, _, version in pairs}
            versions["weavecell"] = stamp["weavecell"]
            kind = "law.json" if name == "provenance.json" else name
            uses = _USES.get(kind, ("panel",))
            return Citations(str(folder), rows, _with_laws((*uses, "picture"), rows), versions)
    allowed = "a folder of results of this version of weavecell"
    raise InputError(key="target", value=str(folder), allowed=allowed)


def _of_input(name: str) -> Citations:
    """Read what a run with an input file, a fabric file or a fabric would use."""
    if name not in catalogue.list_names() and not name.endswith(".toml"):
        raise unknown_target(name)
    with _silent():
        fabrics, laws, text = _materials(name)
    return _of_panel(name, tuple(sources.list_sources(fabrics, laws, text)))


def _materials(name):
    """(fabrics, laws, text of the input file) of an input file or a fabric."""
    if name in catalogue.list_names():
        of_shot = resolve_target(name, {}, "shot").setup
        return of_shot.fabrics, of_shot.laws or (), ""
    text, table = read_toml(name, what="input file or fabric")
    if set(coupons.TESTS) & set(table):
        scene = check_scene(coupons.CouponScene, table, Path(name), "coupon")
        case = build.build(scene, Path(name), name)
        return (case.fabric,), case.laws, text
    if not is_input_file(name):
        # a fabric file may have no law yet
        return (catalogue.read(name),), (), ""
    of_shot = read_target(name, Path.cwd(), "shot").setup
    laws = [law for ply in of_shot.lay_up or (of_shot,) for law in ply.laws or ()]
    return of_shot.fabrics, laws, text


def _with_laws(uses: tuple[str, ...], rows: Iterable[Source]) -> tuple[str, ...]:
    """Return the uses, with the 3D crossover where a law was fitted to it."""
    if any(row.status == "fitted" and row.text.startswith(_FITTED_BY) for row in rows):
        return (*uses, "crossover")
    return uses


@contextmanager
def _silent() -> Iterator[None]:
    """Keep the lines on assumptions out of what is printed, where comments have them."""
    log = logging.getLogger("weavecell")
    level = log.level
    log.setLevel(logging.WARNING)
    try:
        yield
    finally:
        log.setLevel(level)
