"""Chapters of a calibration: the fit of the law, the solid if it was fitted, the response of the shells' cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from weavecell.report import chapters, pictures, pictures_biaxial, pictures_crossover
from weavecell.report.page import Section, Table
from weavecell.report.solid_words import (
    list_solid,
    name_constants,
    say_forces,
    say_misfit,
    say_parts,
)
from weavecell.results import display
from weavecell.results.named_value import NamedValue, tabulate

if TYPE_CHECKING:
    from pandas import DataFrame

    from fabrics.base.record import Record
    from fabrics.compression import CompressionLaw
    from unitcell3d.identify.calibration import Calibration

YARNS = ("warp", "weft")
FROM_FITTED = "rms from the fitted law"


def list_chapters(found: Any, laws: DataFrame) -> tuple[Section, ...]:
    """Return the chapters of a CalibrationResult.

    Parameters
    ----------
    laws : table of its laws, with intervals and spread
    """
    fabric = found.mesh.fabric
    w1, w2 = fabric.weave.w
    paths = {}
    for name, path in list_paths(found.calibration).items():
        paths[name] = (path["d1"] / w1, path["d2"] / w2, path["T1"], path["T2"])
    of_cell = {label: (law, law) for label, law in list_fitted(found.calibration).items()}
    solid = [] if found.solid is None else [_list_solid_constants(found)]
    return (_fit(found, laws), *solid, chapters.cell(fabric, of_cell, paths=paths))


def list_paths(done: Calibration) -> dict[str, Record]:
    """Return {path: Record} without the plates."""
    return {name: path for name, path in done.histories.items() if path is not done.plates}


def list_fitted(done: Calibration) -> dict[str, CompressionLaw]:
    """Return {label: law} of the fit and of the publication, if there is one."""
    laws = {"fitted": done.law}
    if done.published is not None:
        laws["published"] = done.published
    return laws


def collect_fit(done: Calibration) -> tuple[Any, ...]:
    """Return the arguments of `pictures.fit`."""
    from unitcell3d.identify.calibration import samples

    points = {name: samples(path) for name, path in list_paths(done).items()}
    return points, list_fitted(done), (done.plates["F_c"], done.plates["d_c"])


def _fit(found, laws):
    """Samples and laws, each path alone, and fibre failure."""
    done = found.calibration
    caption = f"Fitted laws, {say_forces(found.law)}; impacts use the fitted one"
    ratio = done.ratio_law
    if ratio is not None:
        ends = [ratio.compliance(m) for m in ratio.m_range]
        compliance = NamedValue("c", None, "m/N", *ends, form=".3f")
        caption += f"; alternative: c F / (1 + F / {ratio.F0:.3g} N), {compliance.line()}, all weft .. all warp"
    lead = "Each point is a converged state of the 3D crossover, to which d_c = a - b / (F + F0)^(1/3) is fitted."
    for line in found.law.outside_ends():
        lead += f" Note: {line}."
    drawn = pictures.draw_figure(
        "fit",
        "Compression of one yarn against the contact force.",
        pictures.fit,
        *collect_fit(done),
    )
    tables = (
        Table.from_frame(laws, caption),
        Table.from_frame(_each_path(done), "Each path"),
        Table.from_frame(
            _failures(done.failures), "Where the fibre strain first reaches the failure strain"
        ),
    )
    return Section("fit", "Transverse compression: the fit", lead, (drawn,), tables)


def _each_path(done):
    """The law of each path alone, why the path ended, and how long it took."""
    rows = []
    ends = []
    for name, path in done.histories.items():
        constants = name_constants(None, None, rms_name=FROM_FITTED)
        law = done.path_laws.get(name)
        if law is not None:
            residual = done.residuals.get(name)
            constants = name_constants(law.a, law.b, residual, rms_name=FROM_FITTED)
        rows.append((name, constants))
        ends.append(_explain_end(name, path))
    table = tabulate("path", rows)
    table["ended"] = ends
    table["time [s]"] = [done.seconds[name] for name in done.histories]
    return table


def _explain_end(name, path):
    """Why a path ended."""
    from unitcell3d.identify.calibrate import BOTH

    if path.failed:
        return path.failed
    if name == BOTH:
        return "beyond the failure strain"
    if name != "plates":
        return "at fibre failure"
    if path["path"][-1] < 1:
        return "at the test's pressure"
    return "with the plates at half their distance"


def _failures(found):
    """The state of each path in which a fibre first fails, by each criterion."""
    paths = []
    states = []
    for name, failures in found.items():
        paths += [name] * len(failures)
        states += failures
    columns = {
        "path": ("", paths),
        "criterion": ("", [state.criterion for state in states]),
        "yarn": ("", [YARNS[state.yarn] for state in states]),
    }
    for way, yarn in enumerate(("1", "2")):
        columns[f"d{yarn}"] = ("fine m", [state.d[way] for state in states])
    for way, yarn in enumerate(("1", "2")):
        columns[f"T{yarn}"] = ("N", [state.T[way] for state in states])
    columns["F_c"] = ("N", [state.F_c for state in states])
    return display.frame(columns)


def _list_solid_constants(found):
    """Return the constants of the solid, which of them the measurements determine, and how it
    meets these."""
    from pandas import DataFrame

    solid = found.solid
    rows = []
    loose = []
    for fitted, before, determined in list_solid(solid):
        answer = "yes"
        if not determined:
            answer = "no"
            loose.append(fitted.name)
        value, _ = fitted.numbers()
        value_before, _ = before.numbers()
        rows.append((fitted.name, value, value_before, fitted.interval(), answer))
    columns = [
        "parameter",
        "fitted [SI]",
        "the fabric's file",
        "95 % interval",
        "determined",
    ]
    lead = f"{', '.join(solid.free)} of both yarns, fitted to {solid.source}. "
    drawn = []
    tables = [Table.from_frame(DataFrame(rows, columns=columns))]
    if solid.platens is not None:
        platens = solid.platens
        lead += f"Misfit {say_misfit(platens.misfit)}, before the fit {say_misfit(platens.misfit_before)}. "
        caption = "Closure of the platens against their pressure."
        drawn.append(pictures.draw_figure("solid", caption, pictures_crossover.plates, platens))
    if found.tests is not None:
        caption = (
            "Load of a yarn against the strain along it: points measured, lines the crossover with the fitted "
            "solid, dashed if predicted, dotted with the solid before the fit."
        )
        drawn.append(pictures.draw_figure("tests", caption, pictures_biaxial.draw_pulls, solid))
        tables.append(Table.from_frame(_table_of_tests(found.tests, solid), "Biaxial tests"))
    if loose:
        lead += f"What was measured does not determine {' and '.join(loose)}."
    else:
        lead += "What was measured determines all of them."
    for one in name_constants(found.law.a_interval, found.law.b_interval)[:2]:
        lead += f" {one.name} of the law is then between {' and '.join(one.ends())} {one.unit_shown} (95 %)."
    return Section("solid", "The solid yarn from tests", lead, tuple(drawn), tuple(tables))


def _table_of_tests(tests, solid):
    """Return the biaxial tests with their misfit, as a DataFrame."""
    from pandas import DataFrame

    rows = []
    for one, before, checked in zip(tests.comparisons, tests.before, tests.checked):
        row = {"test": one.name, "strains": one.ratio, "role": one.role}
        row["rms, warp / weft, of the greatest load"] = say_parts(one.shares)
        row["before the fit"] = say_parts(before)
        row[f"on the mesh {solid.sizes[1]}"] = say_parts(checked)
        row["verdict"] = "" if one.fitted else one.verdict
        rows.append(row)
    return DataFrame(rows)
