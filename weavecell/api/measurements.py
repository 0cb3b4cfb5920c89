"""What to measure first: what each measurement would leave of an answer over drawn shots."""

from __future__ import annotations

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from weavecell.answers.measurements import MeasureFirst
from weavecell.answers.result import Result, remember_folder
from weavecell.api.entrance import public
from weavecell.results.finding import Answer

OF_DRAWN = "a result of v50 or plies, or of impact with drawn shots"


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
