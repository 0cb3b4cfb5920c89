"""Published ballistic tests on soft fabrics whose numbers were found, computed from what is known of the fabric.

    python -m validation.published.measured_shots [--out results/measured-shots] [--variants]
        [--page docs/reports/measured-shots.md]

Two sets, both quoted by others: V50 of five packs of Twaron against the fragment simulator of 1.10 g, and two shots of
a 9 mm bullet at 15 plies of Kevlar 29. `measured_shots.toml` has them with their sources and with what is assumed of
the set-up, `measured_fabrics` the fabrics. Packs are struck at their measured V50, where half of the shots of the test
perforate; those of more than 32 plies are not fired. Nothing is fitted to the tests. The compression law comes from the
coarse 3D crossover. Each shot is kept in the folder; with --variants the pack of 21 plies is computed with other
assumptions, and struck faster, too.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import weavecell as wc
from fabrics import run_cache
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from validation.marked_page import markdown
from validation.program import program, publish_all
from weavecell.results import provenance

HERE = Path(__file__).parent
TESTS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
PACK, ARMOUR = "CT612-550", "K29-467"  # of measured_fabrics
BULLET = {"mass": "8.751 g", "diameter": "9 mm", "shape": "hemisphere", "edge_radius": "0.3 mm"}
BULLET_PLIES = 15
VARIED = 21  # plies of the pack of the variants
MOST = 32  # plies of a pack that is fired: more take many minutes a shot
Rows = list[list[str]]


@dataclass(frozen=True)
class Shot:
    """One shot at a pack.

    Parameters
    ----------
    fabric : file of measured_fabrics, without its end
    sheet : text of that file, since a kept result depends on it
    plies : number of them
    velocity : [m/s]
    bullet : whether it is the 9 mm bullet, instead of the fragment simulator
    failure_strain : [-] of the yarns; None takes that at their strength
    """

    fabric: str
    sheet: str
    plies: int
    velocity: float
    bullet: bool = False
    failure_strain: float | None = None


def sheet(name: str) -> str:
    """Text of a file of measured_fabrics."""
    return _file(name).read_text(encoding="utf-8")


def shot_at(fabric: str, plies: int, velocity: float = 0.0, **others: Any) -> Shot:
    """A shot at a pack of a fabric of measured_fabrics."""
    return Shot(fabric, sheet(fabric), plies, velocity, **others)


@cache
def law(name: str) -> CompressionLaw:
    """Compression law of a fabric of measured_fabrics, from the coarse 3D crossover."""
    return wc.calibrate(_file(name), mesh="coarse", assumed_range=False).law


def other_shots() -> dict[str, Shot]:
    """{assumption: shot} at one pack, at its measured V50."""
    [v50] = [test["v50"] for test in TESTS["pack"] if test["plies"] == VARIED]
    given = {one["name"]: {key: one[key] for key in one if key != "name"} for one in TESTS["variant"]}
    return {
        name: shot_at(**{"fabric": PACK, "plies": VARIED, "velocity": v50, **others}) for name, others in given.items()
    }


def fabric_of(shot: Shot) -> Fabric:
    """The fabric of a shot."""
    fabric = wc.fabric(_file(shot.fabric))
    return fabric if shot.failure_strain is None else fabric.with_yarns(failure_strain=shot.failure_strain)


def fire(shot: Shot) -> dict[str, Any]:
    """What a shot comes to, for a file."""
    given = TESTS["set_up"]
    found = wc.impact(
        fabric_of(shot), shot.velocity, law=law(shot.fabric), plies=shot.plies, opening=given["opening"],
        boundary=given["boundary"], end_time=given["end_time"], numerics={"threads": 1},
        projectile=BULLET if shot.bullet else given["projectile"],
    )  # fmt: skip
    summary = found.summary()
    names = ("outcome", "residual_velocity_m_s", "end_time_s", "max_deflection_m", "ply_cut_yarns",
             "energy_error_max", "checks")  # fmt: skip
    return {name: summary[name] for name in names} | {"a": law(shot.fabric).a, "b": law(shot.fabric).b}


def kept(folder: Path) -> Callable[[Shot], dict[str, Any]]:
    """results(shot): what it found, from the folder; it is fired and kept where there is none."""

    def results(shot):
        [found] = run_cache.results(fire, [(shot,)], folder=folder)
        print(f"{shot.fabric}, {shot.plies} plies, {shot.velocity:.1f} m/s: {found['outcome']}", flush=True)
        return found

    return results


def outcome(shot: Mapping[str, Any]) -> str:
    """The outcome of a shot in words."""
    speed = f"{shot['residual_velocity_m_s']:.0f} m/s left"
    return {"stopped": "stops", "perforated": f"**perforates**, {speed}"}.get(shot["outcome"], f"undecided, {speed}")


def cells(shot: Mapping[str, Any], plies: int) -> list[str]:
    """What a table has of a shot at a pack."""
    error = f"{100 * shot['energy_error_max']:.2f}"
    return [outcome(shot), f"{torn(shot)} of {plies}", f"{1e3 * shot['max_deflection_m']:.1f}", error, shot["checks"]]


HEADS = ["computed", "plies with failed yarns", "deflection, mm", "energy error, %", "quality checks"]


def packs(found: Sequence[Mapping[str, Any]]) -> Rows:
    """The shots at the packs at their measured V50; those of more than MOST plies are left out of the shots."""
    rows, shots = [["plies", "kg/m²", "V50 measured = strike, m/s", *HEADS]], iter(found)
    for test in TESTS["pack"]:
        few = test["plies"] <= MOST
        computed = cells(next(shots), test["plies"]) if few else ["not computed", *[""] * (len(HEADS) - 1)]
        rows.append([f"{test['plies']}", f"{test['areal_density']:.1f}", f"{test['v50']:.0f}", *computed])
    return rows


def varied(found: Mapping[str, Mapping[str, Any]]) -> Rows:
    """{variant: shot} of one pack."""
    return [["assumed", *HEADS], *([name, *cells(shot, VARIED)] for name, shot in found.items())]


def torn(shot: Mapping[str, Any]) -> int:
    """Number of plies in which a yarn has failed."""
    return sum(1 for cut in shot["ply_cut_yarns"] if cut)


def bullets(found: Sequence[Mapping[str, Any]]) -> Rows:
    """The shots with the bullet: plies that it perforated, and plies with failed yarns."""
    rows = [["strike, m/s", "plies perforated, test", *HEADS]]
    for test, shot in zip(TESTS["bullet"], found):
        rows.append([f"{test['velocity']:.1f}", f"{test['perforated']} of {BULLET_PLIES}", *cells(shot, BULLET_PLIES)])
    return rows


def laws(names: Sequence[str]) -> Rows:
    """Compression laws of the fabrics."""
    rows = [["fabric", "a, mm", "b, mm N^(1/3)"]]
    return rows + [[name, f"{1e3 * law(name).a:.4f}", f"{1e3 * law(name).b:.4f}"] for name in names]


def main(*, out: Path = Path("results/measured-shots"), page: Path | None = None, variants: bool = False) -> None:
    stamp, results = provenance.stamp(), kept(out)
    struck = [results(shot_at(ARMOUR, BULLET_PLIES, test["velocity"], bullet=True)) for test in TESTS["bullet"]]
    found = [results(shot_at(PACK, one["plies"], one["v50"])) for one in TESTS["pack"] if one["plies"] <= MOST]
    tables = {
        "packs": markdown(packs(found)),
        "bullets": markdown(bullets(struck)),
        "laws": markdown(laws([PACK, ARMOUR])),
    }
    if variants:
        tables["variants"] = markdown(varied({name: results(shot) for name, shot in other_shots().items()}))
    publish_all(tables, page, "validation.published.measured_shots", stamp)


def _file(name):
    return HERE / "measured_fabrics" / f"{name}.toml"


if __name__ == "__main__":
    program(main, variants="other assumptions for one pack")
