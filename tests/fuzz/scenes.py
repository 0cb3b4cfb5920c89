"""Random impact scenes: fabric, projectile, panel and run, as the TOML files that `weavecell impact` reads.

Fabrics of 20 to 350 tex and 50 to 270 GPa, crimp 0.05 to 15 %, with laws in shares of the yarn's thickness; five noses
and STL bodies, 0.2 to 20 g, 20 to 700 m/s, straight or oblique; 1 to 8 plies of one or two fabrics, clamped or free,
some before a block; run until the projectile has flown some millimetres, within a budget of element updates.

All numbers come from the `random()` of one generator. With `random.Random` a scene depends on (seed, index) alone,
whatever the versions of Python and libraries; `scenes()` is the same space as a hypothesis strategy, which shrinks
towards `random() = 0`, so that the plainest choice always comes first.
"""

import math
import random
from dataclasses import dataclass
from pathlib import Path

from fabrics import catalogue
from fabrics.base.errors import InputError
from tests.scene_text import toml

# density [g/cm3], modulus [GPa] and failure strain [%] of the classes of fibres, from their data sheets, rounded out
FIBRES = {
    "aramid": ((1.38, 1.47), (50.0, 150.0), (2.2, 4.5)),
    "polyethylene": ((0.95, 1.00), (50.0, 172.0), (2.5, 4.5)),
    "glass": ((2.45, 2.60), (60.0, 95.0), (3.0, 5.0)),
    "polybenzoxazole": ((1.50, 1.60), (140.0, 270.0), (2.0, 3.6)),
    "carbon": ((1.70, 1.85), (200.0, 270.0), (1.5, 2.1)),
}
# fibre density [g/cm3] of aramid, polyethylene and glass: least and largest strength [GPa] that a fabric file may
# give such yarns (fabrics/families)
STRENGTHS = {(1.38, 1.48): (1.5, 4.5), (0.95, 1.00): (1.5, 5.0), (2.45, 2.65): (0.5, 4.0)}
BODIES = (7.8, 2.7, 17.0)  # [g/cm3] steel, aluminium, tungsten alloy
PLIES = (1, 1, 2, 3, 4)
PACKS = (2, 3, 4, 5, 6, 8)
BACKINGS = ("Roma Plastilina No. 1", "gelatine 10 %", "gelatine 20 %", "")
SHAPES = ("flat", "sphere", "hemisphere", "cone", "chisel")
# as Kevlar 129 in the thesis
_SOLID = {"E_a": "1 MPa", "E_c": "2 GPa", "K_r": 0.02, "K_G": 0.001, "V_c": 1.0, "Vf0": 0.7}
_PACKING = 0.65  # share of fibres in a yarn's section: typical, not a law
_FLATNESS = 4.5  # width of the section over its thickness: typical too
UPDATES = 1.2e7  # element updates that a scene may cost: about a second of one core for one ply
_PACK_COST = 3.0  # of an element update in a pack, over that of a single ply
_FINE_PACK = 3.0  # budgets that a pack on its default mesh may cost
_SHORTEST = 30.0  # [us] that must fit into them
_TRIES = 20  # fabrics that are drawn until one is accepted


@dataclass(frozen=True)
class RandomScene:
    """Tables of a scene, of its fabric and of the second fabric of a lay-up; text of the STL file of its body."""

    name: str
    fabric: dict
    scene: dict
    other: dict
    body: str = ""

    def write(self, folder):
        """Write NAME.toml, NAME-fabric.toml and, where drawn, NAME-other.toml and NAME.stl; the path of the scene."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{self.name}-fabric.toml").write_text(toml(self.fabric), encoding="utf-8")
        if "ply" in self.scene["panel"]:
            (folder / f"{self.name}-other.toml").write_text(toml(self.other), encoding="utf-8")
        if self.body:
            (folder / f"{self.name}.stl").write_text(self.body, encoding="utf-8")
        path = folder / f"{self.name}.toml"
        path.write_text(toml(self.scene), encoding="utf-8")
        return path


def scene(seed, index):
    """Scene number `index` of the sequence `seed`.

    Where its name begins with "packs", "angled" or "backed", it is a pack of 2 to 8 plies: "angled" at any angles and
    with the options of strength, as is every third of "backed", which all stand before a block.
    """
    backed = str(seed).startswith("backed")
    angled = str(seed).startswith("angled") or (backed and index % 3 == 0)
    plies = PACKS if angled or backed or str(seed).startswith("packs") else PLIES
    return sample(random.Random(f"{seed}/{index}"), f"fuzz-{seed}-{index}", plies, angled, backed)


def scenes():
    """The same space as a hypothesis strategy of RandomScene."""
    from hypothesis import strategies

    # what draws the same numbers again and again can come to no fabric that is accepted
    drawn = strategies.randoms(use_true_random=False).map(sample)
    return drawn.filter(lambda scene: is_plausible(scene.fabric))


def sample(generator, name="fuzz", plies=PLIES, angled=False, backed=False):
    """Draw a scene with the generator's `random()`; plies : numbers to choose from; angled, backed : as of `scene`."""
    draw = Draw(generator)
    fabric = sample_fabric(draw, name)
    for _ in range(_TRIES):
        if is_plausible(fabric):
            break
        fabric = sample_fabric(draw, name)
    cells, thickness = _geometry(fabric)
    table = {
        "title": name,
        "fabric": sample_cell(draw, fabric, thickness) | {"file": f"{name}-fabric.toml"},
    }
    half = draw.uniform(12, 40) * max(cells)
    half = max(half, 3.3, 14 * max(cells))
    shot = sample_projectile(draw, half)
    panel = sample_panel(draw, shot, thickness, draw.choice(plies))
    if angled:
        panel = {
            key: value for key, value in panel.items() if key not in ("weave_angle", "stacking")
        }
        panel |= {"boundary": "clamped", "symmetry": "whole"} | sample_strength(draw, fabric)
    run = sample_run(draw, fabric, cells, half, shot, panel)
    if "plies" in panel and draw.chance(0.4):  # last, so that scenes without it are what they were
        panel["ply_friction"] = round(draw.uniform(0, 0.6), 3)
    other = {}
    if "plies" in panel and "weave_angle" not in panel and (draw.chance(0.3) or angled):
        other = sample_other(draw, fabric, name)
        for _ in range(_TRIES):
            if is_plausible(other):
                break
            other = sample_other(draw, fabric, name)
        panel["ply"] = sample_plies(
            draw, panel.pop("plies"), f"{name}-other.toml", thickness, angled
        )
        panel.pop("stacking", None)
        if all("gap" in ply for ply in panel["ply"][:-1]):
            del panel["ply_gap"]
    if panel["boundary"] == "clamped" and draw.chance(0.15):
        panel["opening_shape"] = "round"
    alone = not {"plies", "ply"} & panel.keys()  # a point off the middle needs the whole panel
    if panel["boundary"] == "clamped" and alone and draw.chance(0.05):
        room = 0.6 * (half - _number(shot["diameter"]))
        panel |= {"impact_point": [_text(room * draw.uniform(-1, 1), "mm") for _ in range(2)]}
        panel["symmetry"] = "whole"
    body = ""
    if backed:
        panel["boundary"] = "clamped"
        table["backing"] = sample_backing(draw, half)
        shot = {
            key: value
            for key, value in shot.items()
            if key not in ("obliquity", "azimuth", "yaw", "roll")
        }
        if draw.chance(0.3):
            shot, body = sample_body(draw, shot, f"{name}.stl")
            panel["symmetry"] = "whole"
    # the default costs several times as much
    if alone and "elements_per_crossover" not in run and draw.chance(0.7):
        run["elements_per_crossover"] = 1
    if panel["symmetry"] == "whole" and draw.chance(0.2):
        shape = round(draw.log_uniform(8, 50), 2)
        seed = int(draw.uniform(0, 1000))
        panel["strength"] = {"weibull_shape": shape, "seed": seed}
    return RandomScene(
        name, fabric, table | {"projectile": shot, "panel": panel, "run": run}, other, body
    )


class Draw:
    """Numbers and choices from a generator's `random()`; each is simplest where that is 0."""

    def __init__(self, generator):
        self._random = generator.random

    def uniform(self, low, high):
        return low + (high - low) * self._random()

    def log_uniform(self, low, high):
        return low * (high / low) ** self._random()

    def choice(self, options):
        return options[min(int(self._random() * len(options)), len(options) - 1)]

    def chance(self, share):
        """True in a `share` of the draws."""
        return self._random() > 1 - share


def is_plausible(fabric):
    """Whether the file of a fabric is accepted: about one of twelve has yarns that do not fit its thickness."""
    try:
        catalogue.read("fabric.toml", toml(fabric))
    except InputError:
        return False
    return True


def sample_fabric(draw, name):
    """The table of a fabric file: yarns of one class of fibres; half of the fabrics have two like yarns."""
    density, modulus, strain = FIBRES[draw.choice(tuple(FIBRES))]
    alike = draw.choice((True, False))
    warp = None
    found = {"name": f"{name}-fabric"}
    for family in ("warp", "weft"):
        if warp is None or not alike:
            warp = {
                "linear_density": draw.log_uniform(20, 350),
                "fibre_density": draw.uniform(*density),
                "modulus": draw.log_uniform(*modulus),
                "failure_strain": draw.uniform(*strain),
            }
        tex, rho, E, e = warp.values()
        e = _possible_strain(rho, E, e)
        found[family] = {
            "linear_density": _text(tex, "tex"),
            "fibre_density": _text(rho, "g/cm^3"),
            "modulus": _text(E, "GPa"),
            "failure_strain": _text(e, "%"),
            "crimp": _text(draw.log_uniform(0.05, 15), "%"),
            "count": _text(draw.uniform(0.5, 1.0) * 150 / math.sqrt(tex), "/cm"),
        }
        found.setdefault("compression", {})[family] = _law(draw, thickness_of(tex, rho))
    for family, law in found["compression"].items():
        found["compression"][family] = _thinner(law, _heights(found))
    # [MPa], E-07
    locking = 0.5e3 * E * tex / rho * 1e-3 / (2 * thickness_of(tex, rho) * _spacing(found["warp"]))
    angle = draw.uniform(0.05, 0.4)
    found["shear"] = {
        "G1": _text(locking * draw.log_uniform(1e-4, 1e-2), "MPa"),
        "G2": _text(locking * draw.uniform(0.05, 1), "MPa"),
        "gamma1": round(angle, 3),
        "gamma2": round(angle + draw.uniform(0.1, 0.6), 3),
    }
    # the assumed one is at most a spacing, with which meshes of the finest weaves take minutes
    found["failure_length"] = "0.75 mm"
    # yarns of no known fibre have none assumed
    found["solid"] = {family: dict(_SOLID) for family in ("warp", "weft")}
    return found


def _possible_strain(density, modulus, strain):
    """[%] failure strain, or the nearest with which yarns of this density and modulus have a strength of their kind."""
    for (least, most), (weakest, strongest) in STRENGTHS.items():
        if least <= density <= most:
            return min(max(strain, 102 * weakest / modulus), 98 * strongest / modulus)
    return strain


def _law(draw, thickness):
    """a [mm] a share of the yarn's thickness [mm], b [mm N^(1/3)] by the force (b / a)^3 at which it stiffens."""
    a = thickness * draw.uniform(0.02, 0.35)
    return {
        "a": _text(a, "mm"),
        "b": _text(a * draw.log_uniform(0.02, 100) ** (1 / 3), "mm * N^(1/3)"),
    }


def _thinner(law, heights):
    """The law, or one of its form whose closures stay below the yarns' mean height, half of `heights` [mm]."""
    a, unit = law["a"].split()
    share = min(1.0, 0.45 * heights / float(a))
    b, b_unit = law["b"].split(" ", 1)
    return {"a": _text(share * float(a), unit), "b": _text(share * float(b), b_unit)}


def _heights(fabric):
    """[mm] height of the warp and the weft of a fabric together, at the least."""
    pairs = (("warp", "weft"), ("weft", "warp"))
    return sum(_height(fabric[family], fabric[other]) for family, other in pairs)


def thickness_of(tex, density):
    """[mm] of a yarn of a linear density [tex] and fibre density [g/cm3] in a weave."""
    area = 1e-3 * tex / density / _PACKING
    return math.sqrt(4 * area / (math.pi * _FLATNESS))


def sample_cell(draw, fabric, thickness):
    """The table [fabric] of a scene but for its file."""
    found = {
        "cell_model": draw.choice(
            ("compressible", "compressible", "compressible", "incompressible", "decoupled")
        )
    }
    if draw.chance(0.1):
        found["cell_formulation"] = "equilibrium"
    heights = _heights(fabric)
    if found["cell_model"] == "compressible" and draw.chance(0.4):
        law = _thinner(_law(draw, thickness), heights)
        found["law"] = {"a": law["a"], "b": law["b"].replace(" * ", " ")}
    if found["cell_model"] != "decoupled" and draw.chance(0.3):
        found["crossover_gap"] = _text(draw.uniform(0, 0.5) * heights, "mm")
    return found


def _height(yarn, other):
    """[mm] height at rest of straight segments of the yarn's crimp: a lower bound of that of a cosine."""
    crimp = _number(yarn["crimp"]) / 100
    return 0.5 * _spacing(other) * math.sqrt(crimp * (2 + crimp)) * (2 / math.pi)


def sample_projectile(draw, half):
    """The table [projectile] for a panel of a half width [mm]."""
    diameter = draw.log_uniform(3, min(15, 0.95 * half))
    shape = draw.choice(SHAPES)
    speed = draw.uniform(20, 700)
    found = {
        "shape": shape,
        "diameter": _text(diameter, "mm"),
        "strike_velocity": _text(speed, "m/s"),
    }
    radius = 0.5 * diameter
    depth = radius
    slenderness = draw.uniform(0.7, 3)
    if shape != "sphere":
        edge = max(0.1, radius * draw.log_uniform(0.04, 0.3))
        found["edge_radius"] = _text(edge, "mm")
    if shape == "cone":
        angle = draw.uniform(20, 75)
        c = math.cos(math.radians(angle))
        found["half_angle"] = _text(angle, "deg")
        found["tip_radius"] = _text(draw.uniform(0.08, 0.8) * (radius - edge * (1 - c)) / c, "mm")
        depth = radius / math.tan(math.radians(angle)) + edge
    if shape == "chisel":
        angle = draw.uniform(15, 60)
        strip = draw.uniform(0.1, 0.8) * (radius - edge) + edge * math.tan(
            0.5 * math.radians(angle)
        )
        found |= {"flat_width": _text(2 * strip, "mm"), "flat_angle": _text(angle, "deg")}
        depth = edge + radius * math.tan(math.radians(angle))
    length = max(slenderness * diameter, 1.05 * (depth + 0.3 * radius))
    if shape != "sphere" and draw.chance(0.5):
        found["length"] = _text(length, "mm")
    volume = (
        math.pi / 6 * diameter**3
        if shape == "sphere"
        else math.pi * radius**2 * (length - 0.5 * depth)
    )
    found["mass"] = _text(min(max(1e-3 * volume * draw.choice(BODIES), 0.2), 20), "g")
    if draw.chance(0.5):
        found["friction"] = round(draw.uniform(0, 0.6), 3)
    if draw.chance(0.3):
        lean = draw.uniform(1, 60)
        found |= {"obliquity": _text(lean, "deg"), "azimuth": _text(draw.uniform(0, 360), "deg")}
        if draw.chance(0.3):
            found["yaw"] = _text(draw.uniform(-10, 14), "deg")
            roll = _text(draw.uniform(0, 180), "deg")
            # other shapes look alike from all sides
            if shape == "chisel":
                found["roll"] = roll
    return found


def sample_body(draw, shot, file):
    """The table [projectile] with the body of an STL file for its nose, and its text: a frustum of 3 to 6 sides."""
    radius = 0.5 * _number(shot["diameter"])
    sides = draw.choice((4, 3, 5, 6))
    front = radius * draw.uniform(0.3, 1)
    length = radius * draw.uniform(0.8, 3)
    corners = [
        (math.cos(2 * math.pi * k / sides), math.sin(2 * math.pi * k / sides)) for k in range(sides)
    ]
    ends = [[(r * x, r * y, z) for x, y in corners] for r, z in ((radius, 0.0), (front, length))]
    faces = []
    for k in range(sides):
        (a, b), (c, d) = ((ring[k], ring[(k + 1) % sides]) for ring in ends)
        faces += [(a, b, c), (c, b, d), ((0, 0, 0.0), b, a), ((0, 0, length), c, d)]
    lines = ["solid body"]
    for face in faces:
        points = "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in face)
        lines.append(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet")
    kept = ("strike_velocity", "friction")
    edge = _text(radius * draw.uniform(0.08, 0.25), "mm")
    found = {key: shot[key] for key in kept if key in shot}
    found |= {"shape": "stl", "stl": file, "stl_unit": "mm", "edge_radius": edge}
    found["density"] = _text(draw.choice(BODIES), "g/cm^3")
    return found, "\n".join([*lines, "endsolid body\n"])


def sample_backing(draw, half):
    """The table [backing] behind a panel of a half width [mm]: small and coarse."""
    found = {
        "size": [
            _text(2.2 * half, "mm"),
            _text(2.2 * half, "mm"),
            _text(draw.uniform(20, 60), "mm"),
        ],
        "min_size": _text(draw.uniform(1.5, 3), "mm"),
        "growth": 1.4,
        "outer_boundary": draw.choice(("fixed", "absorbing", "free")),
    }
    material = draw.choice(BACKINGS)
    if material:
        found["material"] = material
    else:
        found["modulus"] = "100 MPa"
    if draw.chance(0.3):
        found["standoff"] = _text(draw.uniform(0, 3), "mm")
    return found


def sample_panel(draw, shot, thickness, plies):
    """The table [panel] but for its opening."""
    found = {"boundary": draw.choice(("clamped", "clamped", "free"))}
    if draw.chance(0.15):
        found["boundary"] = dict(
            zip(("warp", "weft"), draw.choice((("clamped", "free"), ("free", "clamped"))))
        )
    oblique_weave = found["boundary"] == "clamped" and draw.chance(0.15)
    found["symmetry"] = "whole" if "obliquity" in shot or oblique_weave else "quarter"
    if plies > 1:
        found |= {"plies": plies, "ply_gap": _text(thickness * draw.uniform(0, 0.8), "mm")}
        if not oblique_weave and draw.chance(0.5):
            found["stacking"] = "alternating"
    if oblique_weave:
        found["weave_angle"] = _text(draw.uniform(2, 60), "deg")
    return found


def sample_other(draw, fabric, name):
    """The table of a fabric with other counts and modulus than the first."""
    found = {
        key: dict(value) if isinstance(value, dict) else value for key, value in fabric.items()
    }
    counts = draw.uniform(0.8, 1.25)
    modulus = draw.uniform(0.6, 1.5)
    for family in ("warp", "weft"):
        found[family]["count"] = _text(counts * _number(fabric[family]["count"]), "/cm")
        stiffness = modulus * _number(fabric[family]["modulus"])
        found[family]["modulus"] = _text(stiffness, "GPa")
        density, strain = (
            _number(found[family][key]) for key in ("fibre_density", "failure_strain")
        )
        found[family]["failure_strain"] = _text(_possible_strain(density, stiffness, strain), "%")
    return found | {"name": f"{name}-other"}


def sample_strength(draw, fabric):
    """Entries of [panel] for the options of strength, whose data go into the table of the fabric."""
    faster = draw.log_uniform(10, 1000)
    fabric["strain_rate"] = {
        "rates": ["1 / s", _text(faster, "/ s")],
        "strength": [1.0, round(draw.uniform(1, 1.6), 3)],
        "modulus": [1.0, round(draw.uniform(1, 1.3), 3)],
        "source": "drawn",
        "status": "assumed",
    }
    return {"rate_dependence": draw.chance(0.3)}


def sample_plies(draw, count, other, thickness, angled=False):
    """The tables [[panel.ply]]: each of either fabric, at 0 or 90 degrees or any angle; some gaps of their own.

    Of the fabric of the scene is one at the least, and behind the last there is no gap.
    """
    found = []
    for _ in range(count):
        ply = {
            "angle": _text(draw.uniform(-90, 90), "deg")
            if angled
            else draw.choice(("0 deg", "90 deg"))
        }
        if draw.chance(0.5):
            ply["file"] = other
        if draw.chance(0.3):
            ply["gap"] = _text(thickness * draw.uniform(0, 0.8), "mm")
        found.append(ply)
    found[-1].pop("gap", None)
    if all("file" in ply for ply in found):
        del found[0]["file"]
    return found


def sample_run(draw, fabric, cells, half, shot, panel):
    """The table [run], and the panel's opening, within the budget of element updates."""
    E = _number(fabric["warp"]["modulus"])
    rho = _number(fabric["warp"]["fibre_density"])
    step = 0.7 * min(cells) / math.sqrt(E / rho / 2)  # [us], from mm and mm/us
    speed = 1e-3 * _number(shot["strike_velocity"])
    diameter = _number(shot["diameter"])
    plies = panel.get("plies", 1)
    whole = panel["symmetry"] == "whole"
    end = min(max(draw.uniform(6, 25) / speed, 100), 250)
    per_step = (
        (4 if whole else 1) * plies * (_PACK_COST if plies > 1 else 1) / (cells[0] * cells[1])
    )
    least = max(1.06 * diameter, 12 * max(cells))
    half = max(least, min(half, math.sqrt(UPDATES * step / end / per_step)))
    end = max(60, min(end, UPDATES * step / (per_step * half**2)))
    panel["opening"] = _text(2 * half, "mm")
    found = {"end_time": _text(end, "us"), "snapshot_interval": "20 us", "outputs": []}
    # updates x step with two elements per crossover, which packs have by default
    fine = end * per_step * half**2 * 8
    if fine < UPDATES * step and draw.chance(0.3):
        found["elements_per_crossover"] = 2
    elif plies > 1 and fine > _FINE_PACK * UPDATES * step:
        end *= _FINE_PACK * UPDATES * step / fine
        found |= (
            {"end_time": _text(end, "us")} if end > _SHORTEST else {"elements_per_crossover": 1}
        )
    return found


def _geometry(fabric):
    """([mm] cell along warp and weft), [mm] thickness of the thicker yarn."""
    yarns = [fabric[family] for family in ("warp", "weft")]
    thickness = max(
        thickness_of(_number(y["linear_density"]), _number(y["fibre_density"])) for y in yarns
    )
    return (_spacing(yarns[1]), _spacing(yarns[0])), thickness


def _spacing(yarn):
    return 10 / _number(yarn["count"])


def _text(number, unit):
    """A quantity as scenes have it, with four digits."""
    return f"{float(f'{number:.4g}'):g} {unit}"


def _number(text):
    return float(text.split()[0])
