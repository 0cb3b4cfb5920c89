"""What a command shoots at: an input file, a fabric of the catalogue, or a fabric file.

A fabric is shot at as in the tests of the thesis: one ply, 203 mm square and clamped, struck by the
flat cylinder of 3 g and 5.5 mm (`scenes.impact.standard_shot`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.schema import read_toml
from weavecell.scenes import build, words
from weavecell.scenes import impact as scenes
from weavecell.scenes.honoured import Keys

ALLOWED = "an input file or fabric file (*.toml), or one of "
_OF_A_SCENE = {"fabric", "projectile", "panel", "run"}


@dataclass(frozen=True)
class Target:
    """What is shot at.

    Parameters
    ----------
    case : build.Case; None of a set-up that was made in Python
    setup : ImpactSetup
    text : of the input file; that of a fabric is the standard one, "" if no file can say what is
        shot at
    name : as it was given
    from_file : whether it is an input file
    """

    case: build.Case | None
    setup: Any
    text: str
    name: str
    from_file: bool

    @property
    def title(self) -> str:
        """The fabric, with the number of its plies."""
        return self.setup.title

    @property
    def shot_title(self) -> str:
        """The title of the input file, or fabric, plies and strike velocity."""
        own = None
        if self.case is not None:
            own = self.case.scene.title
        return own or f"{self.title}, {self.setup.strike_velocity:g} m/s"

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
    def projectile(self) -> str | None:
        """The projectile in words; None of a set-up."""
        if self.case is None:
            return None
        return words.shot_in_words(self.case.scene.projectile)

    @contextmanager
    def named(self) -> Iterator[None]:
        """An InputError inside this block names the input file and its key."""
        try:
            yield
        except InputError as problem:
            raise self.in_file(problem) from None

    def in_file(self, problem: InputError) -> InputError:
        """An InputError of what an input file asks, with the file and its key in it; any other as
        it is."""
        if not self.from_file or not build.of_file(problem):
            return problem
        return build.in_file(problem, self.name)


def read(
    name: str, out: Path, refused: Keys, *, changes: Mapping[str, Any] | None = None
) -> Target:
    """The target of a name.

    Parameters
    ----------
    name : of a file or a fabric
    out : folder of the results, from which the standard scene of a fabric file is named
    refused : keys of an input file that are not honoured (`honoured`)
    changes : {dotted key: value as it is written} in place of what the scene says

    Raises
    ------
    InputError : no such file or fabric, a wrong one, or a key that the command does not honour
    """
    stem = Path(name).stem
    if name in catalogue.list_names():
        fabric = {"name": name}
    elif name.endswith(".toml"):
        text, table = read_toml(name, what="input file or fabric")
        if _OF_A_SCENE & set(table):
            return _target(
                scenes.check(changed(table, changes), name, refused),
                name,
                stem,
                text,
                from_file=True,
            )
        catalogue.read(name)
        fabric = {"file": os.path.relpath(name, out)}
    else:
        raise unknown(name)
    table = {"fabric": fabric, **scenes.standard_shot()}
    text = tomlkit.dumps(table)
    return _target(
        scenes.check(changed(table, changes), out / "scene.toml", refused), name, stem, text
    )


def unknown(name: str) -> InputError:
    """The InputError of a target that is neither a fabric of the catalogue nor a *.toml file."""
    return catalogue.unknown(name, ALLOWED + ", ".join(catalogue.list_names()), key="target")


def is_input_file(name: str) -> bool:
    """Whether a name is the path of an input file, and not of a fabric file or a fabric.

    Raises
    ------
    InputError : no such file, or not TOML
    """
    return name.endswith(".toml") and bool(
        _OF_A_SCENE & set(read_toml(name, what="input file or fabric")[1])
    )


def changed(table: dict[str, Any], changes: Mapping[str, Any] | None) -> dict[str, Any]:
    """The table of a scene with the values of dotted keys in place of its own.

    Raises
    ------
    InputError : a key inside of a value
    """
    for key, value in (changes or {}).items():
        *parts, last = key.split(".")
        inner = table
        for part in parts:
            inner = inner.setdefault(part, {})
            if not isinstance(inner, dict):
                raise InputError(
                    key=key,
                    value=value,
                    allowed=f"left out: {part} is not a table of the input file",
                )
        inner[last] = value
    return table


def _target(scene, name, stem, text, from_file=False):
    # this logs a projectile that has a name or a file
    case = build.build(scene, name, stem)
    if scene.projectile.name is None and scene.projectile.stl is None:
        build.LOG.info(f"projectile: {words.shot_in_words(scene.projectile)}")
    return Target(case, build.setup(case, name), text, name, from_file)
