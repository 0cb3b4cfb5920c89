"""What to measure first: what each measurement would leave of an answer over drawn shots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result, remember_folder
from weavecell.api.entrance import public
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.runs.measurement import Measurement

OF_DRAWN = "a result of v50 or plies, or of impact with drawn shots"
LISTED = 4  # measurements that are printed


@public
def measure_first(folder: FilePath | Result) -> MeasureFirst:
    """List what to measure first: by how much each quantity, once it is known, narrows an answer over drawn shots.

    Nothing is fired: what each quantity moves is known from the shots. Each stands with the test that
    measures it, and with the command or the key of an input file that takes it. `measure_first` in the JSON
    file of the folder has the same.

    Parameters
    ----------
    folder : of `v50`, `plies`, or `impact` with drawn shots; in Python also their result

    Returns
    -------
    MeasureFirst, what narrows the answer most first

    Raises
    ------
    InputError : no such folder, one that was changed, or a result without drawn shots

    Examples
    --------
    >>> found = wc.v50("S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> [one.key for one in wc.measure_first(found).found]
    ['panel.crossover_friction', 'projectile.friction']
    """
    from weavecell.results import result_folder
    from weavecell.runs.measurement import Measurement

    place: FilePath | None
    if isinstance(folder, Result):
        live = getattr(folder, "measurements", None)
        if live is not None:
            return MeasureFirst(folder.answer.subject, live, folder.answer.doubts)
        place = folder.folder
    else:
        place = folder
    if place is None:
        raise _refuse(type(folder).__name__)
    opened = result_folder.open_folder(place, allowed="a folder of results, the out of a run")
    kind = opened.find_kind()
    content = opened.read_json(kind) if kind is not None else {}
    if "measure_first" not in content:
        raise _refuse(str(place))
    found = tuple(map(Measurement.read, content["measure_first"]))
    answer = Answer.read(content["answer"])
    result = MeasureFirst(answer.subject, found, answer.doubts)
    remember_folder(result, opened.folder)
    return result


def _refuse(value):
    return InputError(key="folder", value=value, allowed=OF_DRAWN)


@explain_frozen
@dataclass(frozen=True, repr=False)
class MeasureFirst(Result):
    """What measurements would leave of an answer; the table has a row a measurement.

    Parameters
    ----------
    title : of the answer
    found : tuple of `weavecell.runs.measurement.Measurement`, what narrows the answer most first
    doubts : of the answer

    Examples
    --------
    >>> found = wc.v50("S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> wc.measure_first(found).to_dataframe()["quantity"].tolist()
    ['friction between yarns', 'friction on the nose']
    """

    kind = "measure_first"

    title: str
    found: tuple[Measurement, ...]
    doubts: tuple[str, ...] = ()

    @property
    def answer(self) -> Answer:
        """The answer now, and what is left of it once each quantity is known."""
        subject = f"what to measure first: {self.title}"
        if not self.found:
            value = (
                "not determined: all outcomes are alike, or all that limits follow from is given"
            )
            return Answer(subject, value, self.doubts)
        worth = [one for one in self.found if one.is_worth]
        listed = (worth or self.found)[:LISTED]
        now = {one.answer: one.words(one.now) for one in listed}
        said = [f"{name} {words} now" for name, words in now.items()]
        value = ", ".join(said[:2])
        others = len(self.found) - len(worth)
        if not worth:
            value += "; none narrows it by a tenth: fire more shots"
        elif others:
            value += f"; {others} more by less than a tenth"
        of_several = len({one.answer for one in self.found}) > 1
        parts = tuple(one.parts(named=of_several) for one in listed)
        return Answer(subject, value, self.doubts, listed=parts)

    def summary(self) -> dict[str, Any]:
        """Return the answer, and what is measured first."""
        first = self.found[0].quantity if self.found else None
        return {"answer": self.answer.value, "first": first} | self._what_is_doubtful()

    def lines(self) -> list[str]:
        """Write the lines that are printed: each measurement."""
        return [f"{self.answer.value}."] + ["; ".join(one.parts(named=True)) for one in self.found]

    def _items(self) -> Any:
        return self.found

    def table(self) -> DataFrame:
        """Return the table, columns with their units."""
        return self._labelled_columns()

    def _notebook_table(self):
        return self.table()
