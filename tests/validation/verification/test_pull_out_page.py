"""The page of the slip threshold, from made-up results."""

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from validation.program import save
from validation.verification import pull_out as study
from validation.verification.pull_out import section


def made_up(case, shortfall=1.0):
    forces = 12.0 * np.array(case.loads or [pressure / 4e6 for pressure in case.pressures])
    pull = np.linspace(0, 1e-4, 5)
    thresholds = 0.02 + shortfall * 1.05 * case.friction * forces
    return {
        "F_c": forces.tolist(), "T_f": thresholds.tolist(), "geometric": [0.01] * len(forces),
        "mobilised": [0.995] * len(forces), "pull": [pull.tolist()] * len(forces),
        "P": [(T * np.linspace(0, 1, 5)).tolist() for T in thresholds], "force": [[F] * 5 for F in forces],
        "iterations": 120, "states": 27, "seconds": 60.0, "failed": "",
    }  # fmt: skip


def text_of(found):
    return "".join(make(found) for make in (study.thresholds, study.summary, study.cost)) + study.variants(
        found["variants"]
    )


def test_tables_and_picture(tmp_path):
    found = study.gather(made_up)
    text = text_of(found)
    assert "warp pulled: c0 = 0.020 N, mu_eff = 0.2100 at a coefficient of 0.2" in text
    assert "| warp | 12.00 | 2.540 |" in text
    assert "| as it stands | 12.00 | 2.540 | 0.2117 | +0.00 % | 0.995 | 4.4 |" in text
    assert "converged at every state" in text
    save(study.chart, found, to=tmp_path / "pull-out.png")
    assert (tmp_path / "pull-out.png").stat().st_size > 10_000


def test_what_does_not_slide_is_said():
    def stuck(case):
        return made_up(case) | {"F_c": [], "T_f": [], "mobilised": [0.8], "failed": "no equilibrium"}

    text = text_of(study.gather(lambda case: stuck(case) if case == study.WEFT_PULLED else made_up(case)))
    assert "| weft | - | - | - | - | no equilibrium |" in text
    assert "Ended early: no equilibrium" in text
    further = section({name: stuck(case) if case == study.FINER else made_up(case)
                       for name, case in study.FURTHER.items()}, "abc")  # fmt: skip
    assert "| finer mesh, 10 x 8 x 3 | - | - | - | - | no equilibrium |" in further


def test_the_finer_mesh_and_the_platens_have_a_section_of_their_own():
    text = section({name: made_up(case) for name, case in study.FURTHER.items()}, "abc")
    assert "| as it stands | 12.00 | 2.540 | 0.2117 | +0.00 % |" in text
    assert text.count("| between platens |") == 3
    assert "Between platens c0 = 0.020 N and mu_eff = 0.2100" in text
