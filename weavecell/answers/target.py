"""What is shot at, with its input file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed
from fabrics.base.errors import InputError
from weavecell.scenes import build, scene_text, words
from weavecell.scenes import impact as scenes

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup


@dataclass(frozen=True)
class Target:
    """What is shot at.

    Parameters
    ----------
    case : build.Case; None of a set-up that was made in Python
    setup : ImpactSetup
    source : text of the input file, or of keywords the table of the input file that says the same,
        and the fabric; "" of a set-up
    name : as it was given
    from_file : whether it is an input file
    """

    case: build.Case | None
    setup: Any
    source: str | tuple[Mapping[str, Any], object]
    name: str
    from_file: bool

    @property
    def title(self) -> str:
        """The fabric, with the number of its plies."""
        return self.setup.title

    @cached_property
    def text(self) -> str:
        """Text of the input file; that of a fabric is the standard one, "" if no file can say what is
        shot at."""
        if isinstance(self.source, str):
            return self.source
        return scene_text.text(*self.source)

    @property
    def scene(self) -> scenes.Scene | None:
        """Its input file, as it was read; None of a set-up."""
        if self.case is None:
            return None
        return self.case.scene

    @property
    def shot_title(self) -> str:
        """The title of the input file, or fabric, plies and strike velocity."""
        own = None
        if self.case is not None:
            own = self.case.scene.title
        return own or f"{self.title}, {self.setup.strike_velocity:g} m/s"

    @property
    def is_placed(self) -> bool:
        """Whether its input says which point is struck."""
        from shellfabric.yarns.model import aim

        if self.case is not None:
            panel = self.case.scene.panel
            return panel.impact_point is not None or panel.aim_seed is not None
        return tuple(self.setup.impact_point) not in [(0.0, 0.0), aim(self.setup.fabric.weave)]

    def nominal(self) -> Target:
        """Return the target of the one run that stands for all draws."""
        from weavecell.studies import unknown

        return self._resolve(lambda setup: unknown.choose_nominal(setup, self.is_placed))

    def resolved(self) -> Target:
        """Return the target with resolved yarns, if its input does not pin them and they can have
        what it asks for."""
        return self._resolve(lambda setup: setup)

    def _resolve(self, finish):
        """Return the target whose set-up is what `finish` makes of it with resolved yarns, or else
        with pinned ones."""
        from shellfabric.impact.run import check_impact
        from weavecell.studies import places

        given = self.setup
        if self.case is not None and "symmetry" in self.case.scene.panel.model_fields_set:
            # resolved yarns have a part of the panel of their own, but what is asked for has to be one
            with self.name_problems():
                given.plain_panels()

        def pin():
            pinned = given
            if given.instead is not None:
                pinned = replace(given, instead=None)
            return replace(self, setup=finish(pinned))

        if given.pinned or given.projectile.body == "metal" or given.surface is not None:
            return pin()
        setup = finish(places.resolve(given))
        try:
            check_impact(setup, target=setup.plain_target())
        except InputError:
            # a mesh of its own, say, which pinned yarns alone read, or a zone that does not fit the opening
            return pin()
        return replace(self, setup=setup)

    @property
    def law_name(self) -> str:
        """Where the compression laws come from, in words."""
        if self.case is not None:
            named = [(of.fabric.name, of.law_name) for of in self.case.materials or (self.case,)]
        elif self.setup.surface is not None:
            return "3D response surface"
        else:
            plies = self.setup.lay_up or (self.setup,)
            model = self.setup.cell_model
            named = [(p.fabric.name, p.laws[0].provenance if p.laws else model) for p in plies]
        names = dict.fromkeys(named)
        if len(names) == 1:
            return named[0][1]
        return "; ".join(map(": ".join, names))

    @property
    def checkpoint_interval(self) -> float:
        """[s] of the run between its checkpoints; infinite of a set-up, which writes none."""
        if self.case is None:
            return inf
        return self.case.scene.run.checkpoint_interval

    @property
    def projectile(self) -> str | None:
        """The projectile in words; None of a set-up."""
        if self.case is None:
            return None
        return words.shot_in_words(self.case.scene.projectile)

    def keep_input(self, folder: Path) -> None:
        """Write the input file to a folder of results, with copies of the files that it names."""
        from weavecell.results import input_copies

        base = Path.cwd()
        if self.from_file:
            base = Path(self.name).parent
        if self.case is not None:
            input_copies.keep_input(folder, self.text, self.case.scene, base)

    @contextmanager
    def name_problems(self) -> Iterator[None]:
        """Name the input file and its key in an InputError that is raised inside this block."""
        try:
            yield
        except InputError as problem:
            raise self.name_file(problem) from None

    def name_file(self, problem: InputError) -> InputError:
        """Return an InputError of what an input file asks with the file and its key in it; any
        other as it is."""
        if not self.from_file or not build.may_be_of_file(problem):
            return problem
        return build.name_file(problem, self.name)


def list_assumptions(setup: ImpactSetup) -> tuple[str, ...]:
    """Write the lines that name what is assumed of the fabrics of a set-up, and of resolved yarns
    first."""
    lines = [line for fabric in setup.fabrics for line in assumed.lines(fabric)]
    if setup.crossovers is not None:
        lines = [*setup.crossovers.assumed_lines, *lines]
    return tuple(lines)
