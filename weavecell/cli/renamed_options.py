"""Old spellings of commands, options and their values: accepted for one release with a warning, in no help text."""

from __future__ import annotations

import sys

UNTIL = "the next release"
COMMANDS = {"chart": "cost-accuracy"}
_MESH, _JOBS, _POOL = {"--size": "--mesh"}, {"--processes": "--jobs"}, {"--pool": "--executor"}
OPTIONS = {
    "demo": _MESH | _JOBS,
    "mesh": _MESH | {"--gap": "--yarn-gap"},
    "calibrate": _MESH | _JOBS | {"--plates": "--platen-curve"},
    "surface": _MESH | _JOBS,
    "crossover": _MESH
    | {
        "--gap": "--yarn-gap",
        "--one-point": "--reduced-integration",
        "--stretch": "--end-displacement",
        "--gamma": "--shear-angle",
    },
    "biaxial": {"--crossover": "--compare-3d", "--toe": "--fibre-slack"},
    "critical-velocity": {"--curve": "--residual-shots", "--workers": "--jobs"},
    "cost-accuracy": _JOBS,
    "sensitivity": _POOL,
    "v50": _POOL | {"--shape": "--weibull-shape", "--modulus": "--modulus-cov", "--crimp": "--crimp-cov"},
}
VALUES = {
    ("mesh", "--domain"): {"four": "periodic"},
    ("crossover", "--domain"): {"four": "periodic"},
    ("crossover", "--case"): {"plates": "platens"},
    ("sensitivity", "--executor"): {"processes": "local"},
    ("v50", "--executor"): {"processes": "local"},
}


def upgraded(words: list[str]) -> list[str]:
    """The words of a command line with the names of today; one warning line a renamed word on stderr."""
    if not words:
        return words
    command = _renamed(COMMANDS, words[0])
    options, found, option = OPTIONS.get(command, {}), [command], ""
    for word in words[1:]:
        name, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
        if name:
            option = _renamed(options, name)
        if equals or not name:
            value = _renamed(VALUES.get((command, option), {}), value, f"{option} ")
        found.append(f"{option}{equals}{value}" if name else value)
        if equals or not name:
            option = ""
    return found


def _renamed(names, word, before=""):
    new = names.get(word)
    if new is None:
        return word
    print(
        f"warning: {before}{word} is now called {before}{new}; the old name is accepted until {UNTIL}", file=sys.stderr
    )
    return new
