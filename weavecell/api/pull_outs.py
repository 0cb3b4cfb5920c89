"""Friction between yarns from the pull-outs of a laboratory."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, plausible
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import parse_toml
from fabrics.base.schema import validated
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.answers.pull_out_friction import NAMES, PullOutFriction
from weavecell.api import coupons, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize
from weavecell.scenes.panel import PanelTable

if TYPE_CHECKING:
    from weavecell.scenes.build import Case
    from weavecell.studies.pull_out_tests import PullOutTest
# c0 of a coupon of which only the fabric and its cell are read
NO_MATTER = {"displacement": "1 mm", "crossover_cohesion": "1 N"}


@dataclass(frozen=True)
class PullOutPlan(Plan[PullOutFriction]):
    """Pull-outs that are about to be reduced.

    Parameters
    ----------
    case : Case of the coupon, with fabric, law and cell
    tests : that were read
    record : name of their file
    """

    files = NAMES

    case: Case
    tests: tuple[PullOutTest, ...]
    record: str

    def forecast(self) -> WorkSize:
        """Count the tests, and the pull-outs that are computed for them."""
        groups = {test.group for test in self.tests}
        title = f"{self.case.fabric.name}, pull-outs of {self.record}"
        return WorkSize(title, {"test": len(self.tests), "computed peak": len(groups)})

    def run(self, running: Running) -> PullOutFriction:
        """Fit friction and c0."""
        from shellfabric.coupon.pull_out import PullOut
        from weavecell.studies import pull_out_tests as studies

        bending = self.case.scene.fabric.bending
        families = dict.fromkeys(test.pulled for test in self.tests)
        made = {
            pulled: PullOut(coupons.table_of(self.case, pulled), mu=0.0, bending=2 * (bending,))
            for pulled in families
        }
        low, high = assumed.friction_between_yarns(self.case.fabric).number.span
        usual = (low, 0.5 * (low + high), high)
        found = studies.reduce(self.tests, made, usual)
        result = PullOutFriction(self.case, found, self.record, running.wall_time)
        _refuse_friction(result)
        return running.save(result)


def _refuse_friction(result):
    """Refuse a friction that the key of an input file does not allow."""
    mu = result.friction.mu
    if mu is None:
        return
    written = parse_toml(result.keys)["panel"]
    validated(PanelTable, {"opening": "100 mm", **written}, None)
    quantities.note([plausible.Number("panel.crossover_friction", "friction", mu)])


@command(PullOutPlan)
def reduce_pull_out(
    fabric: Fabric | FilePath,
    record: FilePath,
    *,
    more: list[str] | None = None,
    crossings: int | None = None,
    tension: float | str | None = None,
    pulled: str | None = None,
    bending: float | str | None = None,
    law: FilePath | CompressionLaw | None = None,
    check: bool = False,
    out: FilePath | None = None,
) -> PullOutPlan:
    """Reduce yarn pull-outs of a laboratory to the friction between yarns, mu, and c0, with
    intervals.

    RECORD has the columns "displacement [mm]" and "force [N]", one test below the other, or "peak
    load [N]" with a row a test. Further columns, or options, say how many "crossings" the yarn was
    drawn through, or which "length [mm]", and, where they are known, "test", "pulled" (warp or
    weft), and "tension [N]" of each crossing yarn, or the "transverse load [N]" of all of them. Slack
    of the machine at the start does not matter.

    A crossover slips at c0 + mu F_c. Two numbers of crossings with some repeats tell both; one tells
    mu only if c0 is known. The fabric gives the contact force F_c by its crimp and its law.

    The folder then holds report.html, pull-out.json, pull-outs.csv, pull-out.svg, and
    friction-keys.toml for an input file.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    record : records or peaks (``*.csv``)
    more : further record, CROSSINGS=FILE, such as 20=twenty.csv; may be given again, in Python a list
    crossings : that the yarn of the first file is drawn through, if no column says it
    tension : of each crossing yarn, if no column says it [N], such as "2 N"
    pulled : "warp" or "weft", if no column says it; if not given warp
    bending : bending stiffness of a yarn [N m2], with which the load depends on the tension; if not
        given 0
    law : compression law of `weavecell calibrate` (law.json), in place of the fabric's; in Python
        also a CompressionLaw
    check : compute nothing and write nothing: count the tests
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    PullOutFriction

    Raises
    ------
    InputError : a wrong record, no number of crossings, a yarn that would break, or peaks that no
        friction explains

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "10, 0.82\\n10, 0.95\\n20, 3.1\\n20, 3.4\\n"
    >>> _ = Path("peaks.csv").write_text("crossings, peak load [N]\\n" + rows)
    >>> found = wc.reduce_pull_out("S-728", "peaks.csv", tension="2 N")
    >>> round(found.friction.mu, 2)
    0.13
    """
    from weavecell.studies import pull_out_tests as studies

    given = {"bending": bending, "law": law}
    keys = {key: value for key, value in given.items() if value is not None}
    case = coupons.case_of(fabric, "pull_out", NO_MATTER | keys)
    weave = case.fabric.weave
    spacing = {"warp": 2 * weave.w1, "weft": 2 * weave.w2}
    usual: dict[str, Any] = {"pulled": None, "tension": None}
    if pulled is not None:
        family = studies.YARNS.get(str(pulled).lower())
        if family is None:
            raise InputError(key="pulled", value=pulled, allowed="warp or weft")
        usual["pulled"] = family
    if tension is not None:
        usual["tension"] = quantities.number(tension, "N", "tension")
        if not usual["tension"] >= 0:
            raise InputError(key="tension", value=tension, allowed="at least 0")
    count = None
    if crossings is not None:
        count = quantities.read_whole(crossings, "crossings", 1)
    tests = studies.read(record, spacing, crossings=count, **usual)
    for text in more or ():
        number, file = quantities.numbered_file("more", text, "crossings", least=1)
        tests += studies.read(file, spacing, crossings=number, **usual)
    return PullOutPlan(case, tuple(tests), Path(record).name)
