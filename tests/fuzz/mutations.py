"""Mutated inputs: a value, a unit, a key of a file that is right is changed at random, and a command reads it.

    python -m tests.fuzz.mutations --seed 1 --count 2000

A defect is a traceback, an exit code that is none of 0, 2 and 3, a file of the user that is changed, a number a
thousand times off that is accepted without a word, or a wrong unit, type or name of a key that is accepted at all.
"""

from __future__ import annotations

import argparse
import contextlib
import copy
import io
import logging
import random
import shlex
import sys
import tempfile
import traceback
from dataclasses import dataclass
from pathlib import Path

from fabrics.base.units import NUMBER
from tests.scene_text import merged, scale_quantity, toml

SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {
        "mass": "2.9 g",
        "diameter": "5 mm",
        "edge_radius": "0.3 mm",
        "strike_velocity": "120 m/s",
        "friction": 0.1,
    },
    "panel": {"opening": "60 mm"},
    "run": {"end_time": "60 us", "elements_per_crossover": 1},
}
YARN = {
    "linear_density": "1100 dtex",
    "fibre_density": "1.44 g/cm^3",
    "modulus": "90 GPa",
    "tenacity": "2060 mN/tex",
    "failure_strain": "3.3 %",
    "count": "8.5 / cm",
    "crimp": "1.2 %",
}
BASES = {
    "shot": ("impact x.toml --check", SHOT),
    "pack": (
        "impact x.toml --check",
        merged(
            SHOT,
            {
                "panel": {
                    "ply_friction": 0.2,
                    "ply": [{"name": "S-726", "gap": "0.1 mm"}, {"angle": "45 deg", "count": 2}],
                },
                "backing": {
                    "material": "Roma Plastilina No. 1",
                    "size": ["120 mm", "120 mm", "60 mm"],
                    "standoff": "1 mm",
                },
            },
        ),
    ),
    "yarns": (
        "impact x.toml --check",
        merged(
            SHOT,
            {
                "fabric": {"name": "S-726"},
                "panel": {"crossovers": "yarns", "zone": "12 mm", "crossover_friction": 0.25},
            },
        ),
    ),
    "law": (
        "v50 x.toml --check --shots 12",
        merged(SHOT, {"fabric": {"law": {"a": "0.045 mm", "b": "0.058 mm N^(1/3)"}}}),
    ),
    "fabric": (
        "show x.toml",
        {
            "name": "mine",
            "thickness": "0.30 mm",
            "areal_density": "190 g/m^2",
            "warp": YARN,
            "weft": YARN,
            "shear": {"G1": "8.66 MPa", "G2": "8.66 GPa", "gamma1": "0.24", "gamma2": "0.49"},
        },
    ),
}
# a thousandth of these is as good as none, or as fine as one likes; a thousand times as long is never reached
FREE_BELOW = {"friction", "ply_friction", "crossover_friction", "gap", "standoff", "angle"}
FREE = {"end_time", "elements_per_crossover", "count"}
# refused at once: texts that are no quantity
NO_QUANTITY = [
    "",
    "nan mm",
    "inf",
    "1e400 mm",
    "mm",
    "1,5 mm",
    "1..2 mm",
    "\u0663 mm",
    "5+-1 mm",
    "--5 mm",
    "0x10 mm",
]
NO_VALUE = [
    [],
    {},
    True,
    {"value": []},
    [1, 2, 3],
    "\u202e",
    "x" * 5000,
    "[red]",
    "a\nb",
    10**400,
    -0.0,
    float("nan"),
]


@dataclass(frozen=True)
class Mutant:
    """A changed input.

    Parameters
    ----------
    base : of BASES
    what : the change in words
    table : of the file
    must : what has to be said of it: "word" (a note or a refusal), "refusal", or "" for any
    """

    base: str
    what: str
    table: dict
    must: str


def leaves(table, prefix=()):
    """Yield the paths of the values of a table, through tables and lists of tables."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*prefix, key))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for number, part in enumerate(value):
                yield from leaves(part, (*prefix, key, number))
        else:
            yield (*prefix, key)


def holder(table, path):
    """The table that holds the last key of a path."""
    for key in path[:-1]:
        table = table[key]
    return table


def scaled(value, factor):
    """A quantity times a factor; None if it is none."""
    if isinstance(value, list):
        return [scaled(part, factor) for part in value]
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    if not isinstance(value, str):
        return value * factor
    return scale_quantity(value, factor)


def mutate(drawn, name):
    """Draw a Mutant of a base."""
    table = copy.deepcopy(BASES[name][1])
    path = drawn.choice([*leaves(table)])
    inside = holder(table, path)
    key = path[-1]
    value = inside[key]
    dotted = ".".join(map(str, path))
    is_quantity = scaled(value, 1.0) is not None
    has_unit = isinstance(value, str) and is_quantity and value.strip()[-1] not in "0123456789"
    kinds = ["value", "delete", "typo", "elsewhere", "swap", "twice"]
    if is_quantity:
        kinds += ["scale"] * 4
    if has_unit:
        kinds += ["unit", "no unit", "no quantity"] * 2
    kind = drawn.choice(kinds)
    must = ""
    match kind:
        case "scale":
            factor = drawn.choice([1e3, 1e-3, 1e4, -1.0])
            inside[key] = scaled(value, factor)
            if isinstance(value, int):
                inside[key] = round(inside[key])
            free = key in FREE or (factor < 1 and key in FREE_BELOW)
            must = "" if free else "word"
            kind = f"times {factor:g}"
        case "unit":
            other = drawn.choice(
                ["kg", "m", "s", "m/s", "Pa", "N", "deg", "K", "furlong/fortnight"]
            )
            number = NUMBER.match(value)[0]
            inside[key] = f"{number} {other}"
            kind = f"unit {other}"
        case "no unit":
            inside[key] = NUMBER.match(value)[0]
            # a percentage without its sign is a fraction, which the ranges tell
            must = "word" if value.endswith("%") else "refusal"
        case "no quantity":
            inside[key] = drawn.choice(NO_QUANTITY)
            must = "refusal"
        case "value":
            inside[key] = drawn.choice(NO_VALUE)
            kind = f"value {str(inside[key])[:30]!r}"
        case "delete":
            del inside[key]
        case "typo":
            place = drawn.randrange(len(key) + 1)
            wrong = key[:place] + drawn.choice("abcxyz_0") + key[place + drawn.randrange(2) :]
            if wrong != key:
                inside[wrong] = inside.pop(key)
                must = "refusal"
        case "elsewhere":
            tables = [part for part in table if isinstance(table[part], dict)]
            target = drawn.choice(tables)
            if table[target] is not inside:
                table[target][key] = inside.pop(key)
        case "swap":
            other = drawn.choice([*leaves(table)])
            there = holder(table, other)
            inside[key], there[other[-1]] = there[other[-1]], inside[key]
            dotted += f" with {'.'.join(map(str, other))}"
        case "twice":
            inside[f"{key}2"] = value
            must = "refusal"
    return Mutant(name, f"{dotted}: {kind}", table, must)


def say(words):
    """Run a command line in this process: (exit code, standard output, standard error)."""
    from weavecell.cli import app

    out = io.StringIO()
    err = io.StringIO()
    code = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app.main(shlex.split(words))
        except SystemExit as leaving:
            code = leaving.code or 0
        except BaseException:
            code = 1
            traceback.print_exc(file=err)
    for handler in [*logging.getLogger("weavecell").handlers]:
        logging.getLogger("weavecell").removeHandler(handler)
    return code, out.getvalue(), err.getvalue()


def judge(mutant, folder):
    """What is wrong with the answer to a mutant, "" if nothing is; and the exit code."""
    text = toml(mutant.table)
    path = folder / "x.toml"
    content = text.encode("utf-8", "surrogatepass")
    path.write_bytes(content)
    code, out, err = say(BASES[mutant.base][0])
    if "Traceback" in err or code not in (0, 2, 3):
        return f"exit code {code}: {err[-400:]}", code
    if path.read_bytes() != content or [*folder.iterdir()] != [path]:
        return "files are changed", code
    if code == 2 and not err.startswith("error: ") and "\nerror: " not in err:
        return f"no line of an error: {err[-200:]}", code
    told = "note" in out or "note" in err
    if code == 0 and (mutant.must == "refusal" or (mutant.must == "word" and not told)):
        return "accepted without a word", code
    return "", code


def run(count, seed):
    """Judge mutants; yields (Mutant, fault, exit code)."""
    drawn = random.Random(seed)
    names = [*BASES]
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        with contextlib.chdir(folder):
            for number in range(count):
                mutant = mutate(drawn, names[number % len(names)])
                yield (mutant, *judge(mutant, place))
    assert Path.cwd() == here


def main(arguments=None):
    """Draw, run and tell; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=2000)
    chosen = parser.parse_args(arguments)
    codes = {}
    faults = 0
    for mutant, fault, code in run(chosen.count, chosen.seed):
        codes[code] = codes.get(code, 0) + 1
        if fault:
            faults += 1
            print(f"{mutant.base}: {mutant.what}: {fault}", flush=True)
    told = ", ".join(f"{number} with exit code {code}" for code, number in sorted(codes.items()))
    print(f"seed {chosen.seed}: {chosen.count} inputs, {told}; {faults} defects")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
