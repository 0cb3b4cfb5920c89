"""Old spellings of commands, options and their values: accepted for one release with a warning, in no help text."""

from __future__ import annotations

import sys

UNTIL = "the next release"
COMMANDS = {"chart": "cost-accuracy"}
EVERYWHERE = {"--processes": "--jobs", "--workers": "--jobs", "--pool": "--executor"}
_MESH = {"--size": "--mesh"}
OPTIONS = {
    "demo": _MESH,
    "mesh": _MESH | {"--gap": "--yarn-gap"},
    "calibrate": _MESH | {"--plates": "--platen-curve"},
    "surface": _MESH,
    "crossover": _MESH
    | {
        "--gap": "--yarn-gap",
        "--one-point": "--reduced-integration",
        "--stretch": "--end-displacement",
        "--gamma": "--shear-angle",
    },
    "biaxial": {"--crossover": "--compare-3d", "--toe": "--fibre-slack"},
    "critical-velocity": {"--curve": "--residual-shots"},
    "v50": {"--shape": "--weibull-shape", "--modulus": "--modulus-cov", "--crimp": "--crimp-cov"},
}
VALUES = {
    ("", "--executor"): {"processes": "local"},
    ("mesh", "--domain"): {"four": "periodic"},
    ("crossover", "--domain"): {"four": "periodic"},
    ("crossover", "--case"): {"plates": "platens"},
}


def upgraded(words):
    """The words of a command line with the names of today; one warning line a renamed word on stderr."""
    if not words:
        return words
    command = _renamed(COMMANDS, words[0])
    options, found, option = EVERYWHERE | OPTIONS.get(command, {}), [command], None
    for word in words[1:]:
        name, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
        if name:
            option = _renamed(options, name)
        if equals or not name:
            value = _renamed(VALUES.get((command, option), VALUES.get(("", option), {})), value, f"{option} ")
        found.append(f"{option}{equals}{value}" if name else value)
        if equals or not name:
            option = None
    return found


def _renamed(names, word, before=""):
    new = names.get(word)
    if new is None:
        return word
    print(
        f"warning: {before}{word} is now called {before}{new}; the old name is accepted until {UNTIL}", file=sys.stderr
    )
    return new
