"""Constants of a fabric's cell, as biaxial tests determine them.

Its folder
    biaxial-fit.json    constants with intervals and correlation, provenance
    tests.csv           each test, fitted or predicted, with its errors
    curves.csv          measured and computed loads of each test
    law.json            the fitted law, for `law` in an input file
    fabric-keys.toml    what of it a fabric file takes
    surface.h5          of a cell that is no cosine of linear yarns: its forces, for `fabric.surface`
    pictures/           tests, residuals and profiles
    report.html
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.door import option
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import installed
from weavecell.results import display, json_file
from weavecell.results.finding import Answer, join_parts
from weavecell.results.named_value import NamedValue
from weavecell.scenes import result_keys

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from shellfabric.membrane.indicator import Indicator
    from weavecell.studies.biaxial_fit import BiaxialFit, Comparison, Constant

FORMAT = "weavecell biaxial fit 1"
SURFACE = "surface.h5"
NAMES = (
    "biaxial-fit.json",
    "tests.csv",
    "curves.csv",
    "law.json",
    "fabric-keys.toml",
    SURFACE,
    "pictures/tests.svg",
    "pictures/residuals.svg",
    "pictures/profiles.svg",
    "report.html",
)
# stretches a side of the written surface: as many as resolve where contact begins
STRETCHES = 81
YARNS = ("warp", "weft")
WORDS = {True: "yes", False: "no"}


def _pair(values, unit, form):
    """Numbers of warp and weft as "6.06 / 5.79"."""
    return display.number(values, unit, form).replace(", ", " / ")


@explain_frozen
@dataclass(frozen=True, repr=False)
class BiaxialFitResult(WrittenResult):
    """Constants of a fabric's cell that were fitted to biaxial tests; the table has a row a test.

    Parameters
    ----------
    given : Fabric as it went in
    fit : `weavecell.studies.biaxial_fit.BiaxialFit`: constants, correlation, comparisons, profiles
    source : name of the file of the tests
    wall_time : [s] it took
    kept : which of a and b was not fitted though the tests exclude its value

    Examples
    --------
    >>> path = wc.biaxial("glass-balanced", ratio=["1:1"]).paths["1:1"]
    >>> rows = zip(100 * path.strain, path.tension)
    >>> lines = [f"k1, {e[0]}, {e[1]}, {T[0]}, {T[1]}" for e, T in rows]
    >>> heading = "test, warp strain [%], weft strain [%], warp load [N], weft load [N]"
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("\\n".join([heading, *lines[::8]]))
    >>> found = wc.calibrate("glass-balanced", biaxial="tests.csv")
    >>> round(1e3 * found.law.a, 4), round(1e3 * found.law.b, 4)  # [mm], [mm N^(1/3)]
    (0.075, 0.035)
    """

    given: Fabric
    fit: BiaxialFit
    source: str
    wall_time: float = 0.0
    kept: tuple[str, ...] = ()

    kind = "biaxial_fit"

    @property
    def law(self) -> CompressionLaw:
        """Of both yarns, ready for `impact`, with what is doubtful of it."""
        return replace(self.fit.law, doubts="; ".join(self.doubts))

    @property
    def fabric(self) -> Fabric:
        """Fabric with the fitted law, and the fitted crimps if these were free."""
        return replace(self.fit.model.fabric, laws=(self.law, self.law))

    @property
    def tests(self) -> tuple[Comparison, ...]:
        """Each test beside the fitted cell."""
        return self.fit.comparisons

    @property
    def constants(self) -> tuple[Constant, ...]:
        """What was fitted, with intervals."""
        return self.fit.constants

    @property
    def correlation(self) -> list[list[float]]:
        """[-] of the constants with each other, rows in their order."""
        return self.fit.correlation.tolist()

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Whether cosines suit the weave, the tests determine the constants, residuals are noise, and
        predictions agree."""
        return self.fit.checks

    @property
    def doubts(self) -> tuple[str, ...]:
        """As in `Result`; a constant that was kept though the tests exclude it."""
        words = "the tests exclude the {} that was kept: fit a and b"
        return (*super().doubts, *(words.format(name) for name in self.kept))

    @property
    def is_of_shots(self) -> bool:
        """Whether a shot has this very cell with law.json alone: cosines of linear yarns without
        play, whose compression does not depend on their strain."""
        model = self.fit.model
        others = (*model.slack, model.crossover_gap, model.stiffening)
        return model.centreline == "cosine" and not any(others)

    @cached_property
    def surface(self) -> ResponseSurface:
        """The forces of the fitted cell over both strains, for `fabric.surface` of a shot."""
        model = self.fit.model
        axes = [np.linspace(low, high, STRETCHES) for low, high in model.range()]
        found = model.solve_grid(*axes)
        d1, d2 = ((axis - 1) * w for axis, w in zip(axes, model.fabric.weave.w))
        return ResponseSurface(
            d1,
            d2,
            T1=found["N1"],
            T2=found["N2"],
            F_c=found["F"],
            h1=found["h1"],
            h2=found["h2"],
            fabric=model.fabric.name,
            provenance=self.law.provenance,
        )

    @property
    def fitted_constants(self) -> dict[str, dict[str, Any]]:
        """{name of a constant: value, interval, SI unit and whether the tests determine it}"""
        found = {}
        for one in self.constants:
            found[one.name] = {
                "value": one.value,
                "interval": [one.low, one.high],
                "unit": display.si_unit(one.unit),
                "determined": one.determined,
            }
        return found

    @property
    def answer(self) -> Answer:
        """What was found, with what is doubtful of it."""
        texts = [
            f"{name} {constant.text()} ({constant.interval()}, 95 %)"
            for name, constant in self._list_constants()
        ]
        value = join_parts(texts, ", ")
        over = ", ".join(
            f"{one.role} strains {one.ratio} rms {_pair(one.rms, 'N', '.3g')} N"
            for one in self.tests
        )
        advice = ("weavecell impact with fabric.law = law.json",)
        if not self.is_of_shots:
            advice = (f"surface = {SURFACE!r} in [fabric], in place of the law",)
        subject = f"{self.fabric.name}, fitted to biaxial tests"
        return self._find_answer(subject, value, advice=advice, over=over)

    def _what(self):
        return self.title

    def _items(self):
        return self.tests

    def plot(self) -> Figure:
        """Draw a matplotlib figure: measured and computed loads against the strains."""
        from weavecell.report import pictures_biaxial

        return figure(pictures_biaxial.draw_tests, self.fit, self.title)

    @property
    def title(self) -> str:
        """Of the picture and the page."""
        return f"{self.given.name}: biaxial tests of {self.source}"

    def _list_constants(self):
        """[(name, (NamedValue,))] of what was fitted."""
        return [
            (one.name, NamedValue(one.name, one.value, one.unit, one.low, one.high, margin=".3g"))
            for one in self.constants
        ]

    def _correlated(self):
        """(first, second, [-]) of the pair of constants that are most alike; None of one alone."""
        names = [one.name for one in self.constants]
        if len(names) < 2:
            return None
        off = np.abs(np.triu(self.fit.correlation, 1))
        first, second = np.unravel_index(int(off.argmax()), off.shape)
        return names[first], names[second], float(self.fit.correlation[first, second])

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = []
        for name, constant in self._list_constants():
            lines.append((name, f"{constant.text()} ({constant.interval()}, 95 %)"))
        pair = self._correlated()
        if pair is not None:
            lines.append(("correlation", f"{pair[2]:.3f} of {pair[0]} and {pair[1]}"))
        for one in self.tests:
            lines.append((f"test {one.name}", self._say_test(one)))
        loose = [one.name for one in self.fit.undetermined]
        if loose:
            remedy = "another ratio, or fewer constants"
            if len({one.ratio for one in self.tests if one.fitted}) > 1:
                remedy = "higher loads, less noise, or fewer constants"
            text = f"the fitted tests do not determine {', '.join(loose)}: {remedy}"
            lines.append(("note", text))
        if not self.is_of_shots:
            text = f"shots have this cell with surface = {SURFACE!r} in place of the law"
            lines.append(("note", text))
        width = max(13, *(len(name) for name, _ in lines))
        return [f"{name:<{width}} {text}" for name, text in lines]

    def _say_test(self, one):
        """What became of a test."""
        rms = _pair(one.rms, "N", ".3g")
        share = _pair(one.shares, "%", ".2g")
        text = f"{one.role}, strains {one.ratio}: rms {rms} N, {share} % of the greatest load"
        if one.fitted:
            if one.start:
                text += f"; begins {100 * one.start:.3g} % too late"
            return text
        if not one.agrees_with_noise:
            text += f", {_pair(one.missed, '%', '.2g')} % without noise"
        own = _pair(one.rms_at_own_start, "N", ".3g")
        return f"{text}: {one.verdict}; begun {100 * one.own_start:+.3f} % later {own} N"

    def content(self) -> dict[str, Any]:
        """Return what biaxial-fit.json holds, without provenance."""
        from weavecell.report import checks

        return {"format": FORMAT, **self.summary(), **checks.summary(self.checks)}

    def curves(self) -> str:
        """Return curves.csv: measured and computed loads at each state."""
        from pandas import DataFrame, concat

        tables = []
        for one in self.tests:
            columns: dict[str, Any] = {"test": one.name, "role": one.role}
            for m, name in enumerate(YARNS):
                columns[f"strain_{name}"] = one.test.strain[:, m]
            for m, name in enumerate(YARNS):
                columns[f"load_{name}_N"] = one.test.load[:, m]
                columns[f"load_computed_{name}_N"] = one.computed[:, m]
            tables.append(DataFrame(columns))
        return concat(tables).to_csv(index=False, float_format="%.8g")

    def fabric_keys(self) -> str:
        """Return fabric-keys.toml: law and crimps as a fabric file has them."""
        lines = [f"# from {self.source} by `weavecell calibrate {option('biaxial', '').strip()}`"]
        values = self.fit.values
        for name in YARNS:
            if f"{name} crimp" in values:
                lines += [f"[{name}]", self._key("crimp", values[f"{name} crimp"]), ""]
        lines.append("[compression]")
        for name in ("a", "b"):
            if name in values:
                lines.append(self._key(f"compression.{name}", values[name]))
        return "\n".join(lines) + "\n"

    def _key(self, key, constant):
        unit, factor = display.choose_unit(constant.unit)
        unit = unit.replace("mm N", "mm * N")
        numbers = [constant.value, constant.low, constant.high]
        value, low, high = (f"{factor * number:.4g}" for number in numbers)
        origin = f"{self.source}, 95 %: {low} to {high} {unit}"
        return result_keys.entry(key, f"{value} {unit}", origin, self.source, "these tests")

    _written = NAMES

    def _write(self, folder):
        from weavecell.report import chapters, checks, page
        from weavecell.results import provenance

        stamp = provenance.stamp("", self.given)
        json_file.write(
            folder / "biaxial-fit.json", {**self.content(), **self._answered(), "provenance": stamp}
        )
        files.write(folder / "tests.csv", self.to_csv())
        files.write(folder / "curves.csv", self.curves())
        files.write(folder / "fabric-keys.toml", self.fabric_keys())
        if not self.is_of_shots:
            self.surface.write(folder / SURFACE)
        if installed.can_draw():
            section = self._section()
            page.write_pictures([section], folder / "pictures")
            lead = (
                "The unit cell of the fabric at the strains of measured tests: constants are fitted to the chosen "
                "tests, the others are predicted."
            )
            sections = (section, checks.section(self.checks))
            seconds = {"fit": self.wall_time}
            of_page = (lead, (self.fabric,), sections, stamp, seconds, self.answer)
            chapters.write(folder, *of_page)
        # law.json comes last: a folder that has it is complete
        self.law.to_json(folder / "law.json")

    def _section(self):
        from weavecell.report import pictures, pictures_biaxial
        from weavecell.report.page import Section, Table

        drawn = [
            pictures.draw_figure(
                "tests",
                "Load of a yarn against the strain along it: points measured, lines the fitted cell, dashed if "
                "predicted.",
                pictures_biaxial.draw_tests,
                self.fit,
                "",
            ),
            pictures.draw_figure(
                "residuals",
                "Measured less computed loads. Waves in place of noise are what this cell cannot follow.",
                pictures_biaxial.draw_residuals,
                self.fit,
            ),
        ]
        if self.fit.profiles:
            caption = (
                "Rise of the least sum of squares about a constant, the others fitted again; dotted: the interval of "
                "95 %. A flat profile is a constant that the tests do not determine."
            )
            picture = pictures.draw_figure(
                "profiles", caption, pictures_biaxial.draw_profiles, self.fit
            )
            drawn.append(picture)
        tables = (
            Table.from_frame(self._constants_table(), "Fitted constants"),
            Table.from_frame(self._labelled_columns(), "Tests"),
        )
        points = tuple(self.lines()[len(self.constants) :])
        return Section("tests", "Measured and computed", "", tuple(drawn), tables, points)

    def _constants_table(self):
        """Constants with intervals and correlations, as a DataFrame."""
        from pandas import DataFrame

        table = []
        for k, (_, constant) in enumerate(self._list_constants()):
            low, high = constant.ends()
            row = {
                "constant": constant.heading,
                "value": display.number(constant.value, constant.unit),
                "95 %": f"{low} to {high}",
                "determined": WORDS[self.constants[k].determined],
            }
            for other, alike in zip(self.constants, self.fit.correlation[k]):
                row[f"correlation with {other.name}"] = f"{alike:.3f}"
            table.append(row)
        return DataFrame(table)
