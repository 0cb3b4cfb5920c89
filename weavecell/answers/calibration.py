"""A compression law fitted to the 3D crossover, with what it was fitted to.

The folder of `weavecell calibrate`
    law.json            the fitted law with its range, for `law`, and the contact law of plies of a pack
    law-range.json      the laws at the ends of all that is not known of the crossover
    calibration.json    all numbers of the calibration, and provenance.json where they come from
    <path>.h5           histories of the loading paths and between plates; paths.csv, one table of them
    crossover.*         the mesh, as `weavecell mesh` writes it, with quality.png and mesh.json
    solid.json, fabric-keys.toml  fitted solid (--platen-curve, --fit-solid), the second as a fabric file has it
    surface.h5          response surface of the solid (--biaxial with --fit-solid), for `fabric.surface`
    solid-runs          finished runs of the fit, for --resume
    report.html
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import assumed, plausible
from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.law_effect import LawEffect
from weavecell.answers.mesh import MeshResult, names_of
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import chapters_calibration
from weavecell.report.solid_words import (
    NAMES_OF_SOLID,
    list_solid,
    name_constants,
    say_forces,
    say_kept,
    say_misfits,
    say_parts,
    say_shares,
)
from weavecell.results import display, json_file
from weavecell.results.finding import Answer
from weavecell.results.named_value import tabulate
from weavecell.scenes import result_keys

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from shellfabric.membrane.indicator import Indicator
    from unitcell3d.identify.calibration import Calibration
    from unitcell3d.identify.law_range import LawRange
    from unitcell3d.identify.solid_record import SolidFit
    from weavecell.report.page import Section
    from weavecell.studies.solid_tests import SolidTests
YARNS = ("warp", "weft")
FABRIC_KEYS = "fabric-keys.toml"
SURFACE = "surface.h5"
RANGE = "law-range.json"
SOLID_UNITS = {"E_a": " Pa", "E_c": " Pa", "K_r": "", "K_G": "", "V_c": "", "Vf0": ""}


NAMES = (
    "law.json",
    "calibration.json",
    "paths.csv",
    "provenance.json",
    "solid.json",
    RANGE,
    FABRIC_KEYS,
    SURFACE,
    "report.html",
    *names_of("crossover", MeshResult.formats),
)


def range_numbers(around: LawRange) -> dict[str, Any]:
    """Return a LawRange as plain types, for law-range.json."""
    return {
        "unknowns": {
            name: [{"a_m": law.a, "b_m_N^(1/3)": law.b} for law in laws]
            for name, laws in around.ends.items()
        },
        "law_of_the_best_values": {"a_m": around.law.a, "b_m_N^(1/3)": around.law.b},
        "shares_of_the_variance_of_the_compression": around.shares(),
        "covariance_of_ln_a_ln_b": around.covariance.tolist(),
        "without_a_law": around.failed,
    }


@explain_frozen
@dataclass(frozen=True, repr=False)
class CalibrationResult(WrittenResult):
    """A compression law fitted to the 3D crossover.

    Parameters
    ----------
    fabric : Fabric with the fitted law, ready for `impact`, and with its solid law; of a fabric
        that was named with the linear densities of `weavecell.fabric`
    calibration : `unitcell3d.identify.calibration.Calibration`
    mesh : MeshResult of the crossover, with the fabric that was calibrated
    around : `unitcell3d.identify.law_range.LawRange` of what is not known; None if it was not computed
    solid : `unitcell3d.identify.solid_record.SolidFit` of the measurements, or None
    fractions : note on fibre fractions of the mesh that are not those of the fabric, or ""
    surface : ResponseSurface of a solid that was fitted to biaxial tests; an exception if it has no
        equilibrium; or None
    effect : LawEffect of the range on a shot; None without a range, or where the shots perforate
    resumable : whether the folder holds the histories of the paths already, with what `resume`
        needs

    Examples
    --------
    >>> calibrated = wc.calibrate("S-720", mesh="coarse")  # doctest: +SKIP
    >>> calibrated.law.a, calibrated.law.b  # doctest: +SKIP
    """

    fabric: Fabric
    kind = "law"
    uses = ("crossover",)

    calibration: Calibration
    mesh: MeshResult
    around: LawRange | None = None
    solid: SolidFit | None = None
    resumable: bool = False
    fractions: str = ""
    surface: Any = None
    effect: LawEffect | None = None

    @property
    def law(self) -> CompressionLaw:
        """The fitted law, of both yarn families, with what is doubtful of it."""
        return replace(self.calibration.law, doubts="; ".join(self.doubts))

    @property
    def tests(self) -> SolidTests | None:
        """Biaxial tests beside the fitted crossover; None without any."""
        from weavecell.studies.solid_tests import SolidTests

        if self.solid is None or not self.solid.pulls:
            return None
        return SolidTests.of(self.solid)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """As in `Result`: how far the law misses its samples, those of the mesh, and of tests that the
        solid was fitted to."""
        from shellfabric.membrane import quality

        law = self.calibration.law
        of_mesh = self.mesh.checks
        if self.tests is not None:
            of_mesh = (*self.tests.checks, *of_mesh)
        if law.residual_rms is None or not law.a > 0:
            return of_mesh
        return (quality.indicator("misfit of the law", law.residual_rms / law.a), *of_mesh)

    @property
    def doubts(self) -> tuple[str, ...]:
        """As in `Result`; a law that no woven yarn has, and a range without one of its ends."""
        found = [*super().doubts, *["implausible law"] * bool(self._judge_law())]
        return (*found, *(f"end of {name} missing in the range" for name in self._failed))

    @property
    def _failed(self):
        """{unknown: why an end of it has no law}"""
        return {} if self.around is None else self.around.failed

    @property
    def answer(self) -> Answer:
        """The law, and whether to use it."""
        law = self.law
        a, b, _ = name_constants(law.a, law.b)
        ends = name_constants(law.a_interval, law.b_interval)
        value = "; ".join(
            f"{one.line()} ({' to '.join(end.ends())})" if law.a_interval else one.line()
            for one, end in zip((a, b), ends)
        )
        rms = display.text(law.residual_rms or 0, "fine m", ".2f")
        over = f"{counted(len(chapters_calibration.list_paths(self.calibration)), 'path')} of the 3D crossover"
        if self.effect is not None:
            over += f", {self.effect.line()}"
        over += f", {say_forces(law)}, missed by {rms} rms"
        if self.around is not None:
            over += f"; the range from {say_shares(self.around.shares())}"
        for name, text in self._say_tests():
            over += f"; {name} {text}"
        bad = (*self._judge_law(), *law.outside_ends())
        use = "weavecell impact with fabric.law = law.json"
        advice = (
            ("press the fabric between platens (`weavecell reduce compression`)",) if bad else ()
        ) + (() if self._refusal else (use,))
        return self._find_answer(
            f"{self.fabric.name}, compression law of the yarns", value, advice=advice, over=over
        )

    def _judge_law(self):
        """A line about each constant of the law that is not plausible."""
        numbers = plausible.of_laws((self.calibration.law,), self.mesh.fabric, "law")
        if self._refusal:
            return [self._refusal]
        return list(plausible.judge(numbers))

    @cached_property
    def _refusal(self):
        """Why no input file could name the law; "" if one can. What was solved is kept all the same."""
        try:
            fabric = self.mesh.fabric
            law = self.calibration.law
            result_keys.check_fabric(replace(fabric, laws=(law, law)), fabric, "3D crossover")
        except InputError as problem:
            return str(problem)
        return ""

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name the laws that are assumed."""
        return (
            *self.mesh.fabric.notes,
            *assumed.lines(assumed.given(self.mesh.fabric, "failure_length")),
            *filter(None, [self.fractions]),
        )

    def summary(self) -> dict[str, Any]:
        """Return a and b with their 95 % intervals, rms of the fit, and the range over the assumed
        solid law.

        "outside" says at which forces the ends of that range do not bracket the law.
        """
        law = self.law
        numbers: dict[str, Any] = {"fabric": self.fabric.name}
        for value in name_constants(law.a, law.b, law.residual_rms):
            numbers |= value.entries()
        numbers["checks"] = self.checks_text
        a, b, _ = name_constants(law.a_interval, law.b_interval)
        for value, interval in ((a, law.a_interval), (b, law.b_interval)):
            if interval is not None:
                numbers |= value.entries()
        for end, constants in zip(("soft", "stiff"), law.assumed_range or ()):
            a, b, _ = name_constants(*constants)
            numbers |= a.entries(end) | b.entries(end)
        # an assumed range that does not bracket its own law deserves a word
        if law.outside_ends():
            numbers["outside"] = "; ".join(law.outside_ends())
        return numbers | self._what_is_assumed()

    def _what(self):
        return f"{self.mesh.fabric.name}, compression law"

    def _columns(self):
        units = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "d_c": "m"}
        histories = self.calibration.histories
        # paths are of different lengths: one column names the path of each row
        lengths = [len(history["path"]) for history in histories.values()]
        columns: dict[str, Any] = {"path": np.repeat(list(histories), lengths)}
        for name, unit in units.items():
            parts = [np.asarray(history[name]) for history in histories.values()]
            columns[f"{name}_{unit}"] = np.concatenate(parts)
        return columns

    def plot(self) -> Figure:
        """Draw a matplotlib figure: compression of a yarn [um] against contact force [N], samples
        and laws."""
        from weavecell.report import pictures

        return figure(pictures.fit, *chapters_calibration.collect_fit(self.calibration))

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh of the crossover at rest, crossover.vtu; returns its path."""
        return self.mesh.to_vtk(folder)

    def _list_laws(self):
        """List (name, (a, b, rms) as `NamedValue`s): the law with intervals and spread, what it
        leaves out."""
        done = self.calibration
        law = self.law
        rows = [
            ("fitted", name_constants(law.a, law.b, law.residual_rms)),
            ("95 % interval", name_constants(law.a_interval, law.b_interval)),
        ]
        if done.published is not None:
            published = done.published
            constants = name_constants(published.a, published.b, published.residual_rms)
            rows.append(("published", constants))
        if done.spread:
            rows.append(("each path", name_constants(**done.spread)))
        for name, own in zip(("warp alone", "weft alone"), done.yarn_laws):
            if own is not None:
                rows.append((name, name_constants(own.a, own.b, own.residual_rms)))
        for end, constants in zip(("soft", "stiff"), law.assumed_range or ()):
            rows.append((f"{end} end", name_constants(*constants)))
        if done.ratio_law is not None:
            rows.append(("alternative", name_constants(None, None, done.ratio_law.residual_rms)))
        return rows

    def _notebook_table(self):
        return tabulate("law", self._list_laws())

    def sections(self) -> tuple[Section, ...]:
        """Return the chapters of a report that are of the fit and of its cell."""
        return chapters_calibration.list_chapters(self, self._notebook_table())

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        done = self.calibration
        law = self.law
        lines = []
        if done.friction:
            lines.append(("friction", f"{done.friction:g}"))
        if self.solid is not None:
            for fitted, before, determined in list_solid(self.solid):
                remark = ""
                if not determined:
                    remark = ", not determined by what was measured"
                if fitted.name in NAMES_OF_SOLID and fitted.name not in self.solid.free:
                    lines.append(
                        (fitted.name, f"{fitted.text()}, kept ({say_kept(fitted, determined)})")
                    )
                    continue
                interval = f"{fitted.interval()}, 95 %{remark}"
                lines.append((fitted.name, f"{fitted.text()} ({interval}); from {before.text()}"))
            lines += [("misfit", text) for text in say_misfits(self.solid)]
            lines += self._say_tests()
        for name, (a, b, rms) in self._list_laws():
            text = f"{a.line()}, {b.line()}"
            if name == "alternative":
                text = "compliance that depends on the ratio of warp and weft tension"
            if rms.value is not None:
                text += f", {rms.text()} rms"
            lines.append((name, text))
        residual = display.text(law.residual_rms or 0, "fine m", ".2f")
        lines.append(("residual", f"{residual} rms {say_forces(law)}"))
        used = "the fitted law"
        if done.chosen != "one law":
            used += ", although the alternative fits the paths better"
        lines.append(("impacts use", used))
        lines += [("note", line) for line in (*self._judge_law(), *law.outside_ends())]
        if self.around is not None:
            lines.append(("range from", say_shares(self.around.shares())))
        if self.effect is not None:
            lines.append(("shots", self.effect.line()))
        for name, why in self._failed.items():
            lines.append(("no end", f"an end of {name} has no compression law: {why}"))
        if done.contact is not None:
            lines.append(("plies", done.contact.words()))
        for name, path in done.histories.items():
            if path.failed:
                share = display.text(path["path"][-1], "%", ".1f")
                lines.append((name, f"ended at {share} of its path: {path.failed}"))
        return [f"{name:<13} {text}" for name, text in lines]

    def _say_tests(self):
        """Return (name, text) of each biaxial test."""
        lines = []
        tests = self.tests
        if tests is None:
            return lines
        for one, before in zip(tests.comparisons, tests.before):
            text = f"{one.role}, strains {one.ratio}: rms {say_parts(one.shares)} of the greatest"
            text += f", before the fit {say_parts(before)}"
            if not one.fitted:
                text += f": {one.verdict}"
            lines.append((f"test {one.name}", text))
        if isinstance(self.surface, Exception):
            lines.append(("no surface", str(self.surface)))
        return lines

    @property
    def _written(self):
        from unitcell3d.identify.calibrate import file_of

        return (*NAMES, *map(file_of, self.calibration.histories))

    def _write(self, folder):
        from unitcell3d.identify.calibrate import file_of
        from weavecell.report import chapters, checks
        from weavecell.results import provenance

        done = self.calibration
        fabric = self.mesh.fabric
        if self.solid is not None:
            self.solid.write(folder / "solid.json")
            files.write(folder / FABRIC_KEYS, fabric_keys(self.solid))
        if self.surface is not None and not isinstance(self.surface, Exception):
            self.surface.write(folder / SURFACE)
        if self.around is not None:
            effect = self.effect.entries() if self.effect else None
            json_file.write(folder / RANGE, range_numbers(self.around) | {"shots": effect})
        if not self.resumable:
            for name, path in done.histories.items():
                path.write(folder / file_of(name))
        self.mesh.save(folder)
        stamp = provenance.stamp("", fabric)
        json_file.write(folder / "provenance.json", {**stamp, **self._what_is_doubtful()})
        files.write(folder / "paths.csv", self.to_csv())
        lead = (
            "The crossover is stretched along several biaxial paths until its fibres fail; one law is fitted to "
            "the thickness that its yarns lose under their contact force."
        )
        if done.friction:
            lead += f" Coulomb friction between the yarns: {done.friction:g}."
        sections = self.sections()
        picture = (folder / "crossover.png").read_bytes()
        of_mesh = chapters.mesh(self.mesh.words(), picture)
        sections = (*sections, of_mesh, checks.section(self.checks))
        chapters.write(folder, lead, (fabric,), sections, stamp, done.seconds, self.answer)
        # law.json comes last: a folder that has it is complete
        replace(done, law=self.law).write(folder)


def fabric_keys(solid: SolidFit) -> str:
    """Return fabric-keys.toml: the fitted solid as a fabric file has it."""
    lines = [f"# from {solid.source} by `weavecell calibrate`"]
    for name, law in zip(YARNS, solid.fabric.solid_laws or ()):
        lines += ["", f"[solid.{name}]"]
        for key, unit in SOLID_UNITS.items():
            value = f"{getattr(law, key):.6g}{unit}"
            source = {"source": f"as before the fit to {solid.source}", "status": "assumed"}
            if key in solid.free:
                low, high = solid.intervals[key]
                words = f"fitted to {solid.source}, 95 %: {low:.4g} to {high:.4g}{unit}"
                source = {"source": words, "status": "fitted"}
            known = solid.started.sources.get(f"solid.{name}.{key}")
            if key not in solid.free and known:
                source = {part: known[part] for part in ("source", "status")}
            entry = {"value": value} | source
            parts = ", ".join(f"{part} = {json.dumps(text)}" for part, text in entry.items())
            lines.append(f"{key} = {{ {parts} }}")
    return "\n".join(lines) + "\n"
