"""The study of packs: its files, its page."""

from dataclasses import asdict
from pathlib import Path

import numpy as np

from validation.published.packs import __main__ as command
from validation.published.packs import angles, study


def test_numbers_of_neighbouring_plies_are_drawn_together():
    assert command.by_ply([0.0, 0.0]) == "none"
    assert command.by_ply([88.0, 2.0, 2.0, 2.0, 0.0]) == "88, 3 x 2, 0"


def made_up(outcome="stopped", plies=4):
    t = np.linspace(0, 3e-4, 400)
    return {
        "outcome": outcome, "time": 2e-4, "residual_velocity": 10.0, "deflection": 0.01, "failed": [0.0] * plies,
        "peaks": [0.5] * plies, "balance": 1e-3, "deepest": 0.2, "t": t.tolist(), "v": (100 - 3e5 * t).tolist(),
        "force": (-2e3 * np.sin(2e4 * t) ** 2).tolist(), "instants": t.tolist(), "absorbed": (5e4 * t).tolist(),
    }  # fmt: skip


def test_page_and_pictures_from_results(tmp_path, monkeypatch):
    """All shots stop; what does not go into the pictures is told by the tables, between the marks of the page."""

    def results(case, fire=None):
        found = made_up(plies=case.plies) | {"case": asdict(case)}
        if fire is not None:
            passed = [{}] * ((case.fabric, case.plies) == ("S-728", 8))
            found |= {"failed": [7], "held": 3.0, "missed": 0.0, "taken": 2e-3, "back": [{}] * 2, "passages": passed,
                      "time": 1e-4}  # fmt: skip
        return found

    monkeypatch.setattr(study, "kept", lambda folder: results)
    page = tmp_path / "packs.md"
    page.write_text((Path(__file__).parents[3] / "docs" / "reports" / "packs.md").read_text("utf-8"))
    command.main(page=page)
    text = page.read_text("utf-8")
    assert "| 16 | S-726 | 243 | perforates (undecided, E-21) | **stops** |" in text
    assert "| 8 | S-728 | 340 | 100 | 7 | 3 | 0.20 | 0 | 2 | **1** |" in text
    stated = "**5 of the 9 computed outcomes differ from the captions.** 9 of 9 shots stop; no yarn of these fails."
    assert stated in text
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    assert names == {"packs-gaps.png", "packs-gap-forces.png", "packs-stacking.png"}
    assert all(f"figures/{name}" in text for name in names)


def test_the_table_of_angles_compares_with_the_aligned_pack():
    shot = {"outcome": "perforated", "balance": 1e-4, "missed": 0.0}
    found = {
        sequence: [shot | {"absorbed": 20.0 * (1 + 0.1 * (n > 0)) + k} for k, _ in enumerate(angles.VELOCITIES)]
        for n, sequence in enumerate(angles.SEQUENCES)
    }
    head, _, first, other, *_ = angles.table(found).splitlines()
    assert head.startswith("| angles, deg | 210 m/s |")
    assert first.startswith("| 0 / 0 / 0 / 0 | 20.0 J | 21.0 J |")
    assert other.startswith("| 0 / 90 / 0 / 90 | +10.0 % | +9.5 % |")
    assert other.endswith("| +9.1 % | 0.6 % |")
