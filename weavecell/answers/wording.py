"""What is shot at, what is taken for granted of it, and what is chosen: the words of a check, asked of
the objects that the report asks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.scenes.impact import Scene

# (of what, words): a row for each thing that is said
Rows = tuple[tuple[str, str], ...]
# as many of the set-ups that differ from the others are named
NAMED = 3


@dataclass(frozen=True)
class Wording:
    """What a check says of one set-up or of several.

    Parameters
    ----------
    shots : of which set-up, "" of all, and what is shot at, by what
    assumptions : of what, and what is taken for granted
    choices : setting and its value in SI units, of those that are chosen
    """

    shots: Rows = ()
    assumptions: Rows = ()
    choices: Rows = ()

    @classmethod
    def of_setup(
        cls,
        setup: ImpactSetup,
        scene: Scene | None,
        *,
        velocity: bool = False,
        drawn: bool = False,
        body: str = "",
    ) -> Wording:
        """Ask a set-up, as it is run.

        Parameters
        ----------
        scene : of the input file, if there is one, which has the names of what is shot
        velocity : of a shot, whose end time counts; shots of a study end with their outcome
        drawn, body : of `in_words.list_assumptions`
        """
        from shellfabric.impact import in_words
        from weavecell.report import chapters
        from weavecell.studies import inputs

        if not velocity:
            setup = inputs.without_end(setup)
        return cls(
            (("", chapters.describe_shot(setup, scene, velocity=velocity)),),
            tuple(in_words.list_assumptions(setup, body=body, drawn=drawn)),
            tuple(in_words.list_choices(setup).items()),
        )

    @classmethod
    def merge(cls, names: Sequence[str], wordings: Sequence[Wording]) -> Wording:
        """Say what several have alike once, and of the rest whose it is, by their names."""
        return cls(
            _merge_rows(names, [one.shots for one in wordings]),
            _merge_rows(names, [one.assumptions for one in wordings]),
            _merge_rows(names, [one.choices for one in wordings]),
        )

    @property
    def lines(self) -> list[str]:
        """The lines that are printed."""
        lines = [*_write_rows(self.shots), *_write_rows(self.assumptions)]
        if self.choices:
            lines.append(f"chosen, in SI units: {self.settings}")
        return lines

    @property
    def settings(self) -> str:
        """What is chosen, in a line."""
        return "; ".join(" ".join(row) for row in self.choices)

    def summary(self) -> dict[str, str]:
        """Return all of it by name; nothing where nothing is said."""
        found = {
            "shot": " ".join(_write_rows(self.shots)),
            "assumptions": " ".join(_write_rows(self.assumptions)),
            "settings": self.settings,
        }
        if not any(found.values()):
            return {}
        return found


# of a command that says nothing
NOTHING = Wording()


def _write_rows(rows):
    return [": ".join(filter(None, row)) for row in rows]


def _merge_rows(names, tables):
    """Rows of several set-ups in one: those of all as they are, the others with the names of theirs."""
    whose: dict[str, dict[str, list[str]]] = {}
    for name, rows in zip(names, tables):
        for of, words in rows:
            whose.setdefault(of, {}).setdefault(words, []).append(name)
    merged = []
    for of, variants in whose.items():
        for words, having in variants.items():
            label = of
            if len(having) < len(names):
                label = _name_some(having)
                if of:
                    label = f"{of} ({label})"
            merged.append((label, words))
    return tuple(merged)


def _name_some(names):
    """The first of several names, and how many others there are."""
    if len(names) <= NAMED:
        return "; ".join(names)
    return f"{names[0]}; {len(names) - 1} others"
