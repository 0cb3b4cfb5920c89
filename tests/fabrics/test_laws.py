"""Compression, slip, trellis and solid laws: limits, inverses, derivatives, energies, fits, files and errata."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.friction.pull_out import PullOutLaw
from unitcell3d.identify.ratio_law import RatioLaw, imbalance

S720 = CompressionLaw(4.5e-5, 5.8e-5)
FORCES = np.array([1e-6, 0.01, 0.5, 2.0, 30.0, 400.0, 1e5])
RATIO = RatioLaw((np.log(20e-6), 0.2), 2.0)


def test_regularised_law_is_zero_at_rest_and_has_the_printed_limit():
    """Erratum E-05: F0 = (b / a)^3, and b / (3 F0^(4/3)) at rest."""
    assert S720.d(0.0) == 0
    assert S720.d(-3.0) == 0
    assert S720.d(1e18) == pytest.approx(S720.a, rel=1e-5)
    printed = CompressionLaw(S720.a, S720.b, "printed")
    assert S720.d(1e6) == pytest.approx(printed.d(1e6), rel=1e-6)
    assert S720.F0 == pytest.approx(2.141, abs=5e-4)
    assert printed.d(S720.F0) == pytest.approx(0, abs=1e-18)
    assert S720.dd_dF(0.0) == pytest.approx(S720.b / (3 * S720.F0 ** (4 / 3)))


@pytest.mark.parametrize("form", ["regularised", "printed"])
def test_law_inverse_and_derivative(form):
    law = CompressionLaw(S720.a, S720.b, form)
    assert law.F(law.d(FORCES)) == pytest.approx(FORCES, rel=1e-6)
    forces = FORCES[1:]  # the first is below the step that the difference needs
    step = 1e-4 * forces
    slope = (law.d(forces + step) - law.d(forces - step)) / (2 * step)
    assert law.dd_dF(forces) == pytest.approx(slope, rel=1e-6)


def test_energy_is_the_work_of_the_force():
    for d in (1e-6, 2e-5, 4.4e-5):
        assert S720.energy(d) == pytest.approx(quad(S720.F, 0, d, epsrel=1e-12)[0], rel=1e-9)


def test_incompressible_limit():
    law = CompressionLaw.incompressible()
    assert np.all(law.d(FORCES) == 0)
    assert np.all(law.dd_dF(FORCES) == 0)
    assert law.F(1e-9) == np.inf


def test_fit_recovers_the_law_behind_its_samples():
    F = np.geomspace(0.05, 200, 60)
    law = CompressionLaw.fit(F, S720.d(F))
    assert (law.a, law.b) == pytest.approx((S720.a, S720.b), rel=1e-6)
    assert law.residual_rms < 1e-12
    assert law.F_range == pytest.approx((0.05, 200))


def test_intervals_of_the_fit_cover_the_truth():
    rng = np.random.default_rng(720)
    F = np.geomspace(0.5, 150, 40)
    hits = 0
    for _ in range(200):
        law = CompressionLaw.fit(F, S720.d(F) + rng.normal(0, 0.3e-6, F.size))
        hits += (
            law.a_interval[0] < S720.a < law.a_interval[1]
            and law.b_interval[0] < S720.b < law.b_interval[1]
        )
    # both at once: between 90 % (independent) and 95 % (fully correlated), 3 sigma below
    assert 174 <= hits <= 200


def test_law_file_keeps_every_bit(tmp_path):
    """The range of an assumed solid too, of which both ends are laws."""
    F = np.geomspace(0.5, 150, 40)
    d = S720.d(F) + 1e-7 * np.sin(9 * F)
    law = CompressionLaw.fit(F, d, provenance="a test", fabric="S-720")
    ranged = replace(law, assumed_range=((5e-5, 4e-5), (3e-5, 5e-5)))
    for written in (law, ranged):
        written.to_json(tmp_path / "law.json")
        assert CompressionLaw.from_json(tmp_path / "law.json") == written
    assert law.ends() == {}
    ends = {end: (each.a, each.b) for end, each in ranged.ends().items()}
    assert ends == {"soft": (5e-5, 4e-5), "stiff": (3e-5, 5e-5)}


def test_limits_of_the_law_of_the_tension_ratio():
    for m in (-1.0, 0.0, 0.7):
        assert RATIO.d(0.0, m) == RATIO.d(-1.0, m) == 0
        assert RATIO.d(1e-6, m) == pytest.approx(1e-6 * RATIO.compliance(m), rel=1e-6)
        assert RATIO.d(1e9, m) == pytest.approx(40e-6 * np.exp(0.2 * m), rel=1e-8)


@pytest.mark.parametrize("F0", [2.0, np.inf])
def test_fit_finds_the_law_of_the_tension_ratio_behind_its_samples(F0):
    law = RatioLaw(RATIO.p, F0)
    F = np.tile(np.geomspace(0.05, 100, 12), 3)
    m = np.repeat([-0.8, 0.1, 0.9], 12)
    found = RatioLaw.fit(F, m, law.d(F, m))
    assert (*found.p, found.F0) == pytest.approx((*law.p, F0), abs=1e-5)
    assert found.residual_rms < 1e-10
    assert found.m_range == (-0.8, 0.9)


def test_imbalance_of_tensions():
    T1 = np.array([1.0, 0.0, 3.0, 0.0, -0.1])
    T2 = np.array([0.0, 2.0, 1.0, 0.0, 1.0])
    assert imbalance(T1, T2) == pytest.approx([1, -1, 0.5, 0, -1])


def test_the_slip_threshold_is_fitted():
    """T_f = c0 + mu_eff F_c, never negative."""
    F_c = np.array([2.0, 5.0, 11.0, 17.0])
    law = PullOutLaw.fit(F_c, 0.05 + 0.21 * F_c)
    assert law.c0 == pytest.approx(0.05)
    assert law.mu_eff == pytest.approx(0.21)
    assert law.residual_rms < 1e-12
    assert law.threshold([0.0, 10.0, -1.0]) == pytest.approx([0.05, 2.15, 0.05])
    assert PullOutLaw(-0.1, 0.2).threshold([0.1, 1.0]) == pytest.approx([0.0, 0.1])


def test_trellis_stress_is_the_integral_of_the_tangent():
    """Erratum E-11, and its value for S-728 at 0.4."""
    shear = catalogue.load("S-728").shear

    def tangent(g):
        return np.interp(abs(g), [shear.gamma1, shear.gamma2], [shear.G1, shear.G2])

    for gamma in (0.05, 0.12, 0.4, 0.7, 0.9):
        breaks = [b for b in (shear.gamma1, shear.gamma2) if b < gamma]
        expected = quad(tangent, 0, gamma, points=breaks or None)[0]
        assert shear.stress(gamma) == pytest.approx(expected, rel=1e-9)
        assert shear.stress(-gamma) == -shear.stress(gamma)
    assert shear.stress(0.4) == pytest.approx(5.88175e8, rel=1e-5)


def test_solid_law_is_continuous_and_capped():
    """Eqs. 3-10 .. 3-14 with the values of erratum section 7 and the cap of E-20."""
    warp, weft = catalogue.load("S-720").solid_laws
    assert (warp.a_E, warp.b_E) == pytest.approx((1.2245e7, 1.00612), rel=1e-4)
    assert (weft.a_E, weft.b_E) == pytest.approx((1.5510e7, 1.00776), rel=1e-4)
    assert warp.G == pytest.approx(1e6)
    for law in (warp, weft):
        ends = law.transverse_modulus(np.array([0.1, law.Vf0, law.V_c, 1.5]))
        assert ends == pytest.approx([law.K_r * law.E_c] * 2 + [law.E_c] * 2, rel=1e-12)


JOINT = np.array([[0.04, 0.03], [0.03, 0.09]])


def test_a_and_b_are_drawn_together_from_the_range_of_a_law(tmp_path):
    """The middle is the law; many draws have its covariance within two deviations; the file keeps it."""
    law = CompressionLaw(4e-5, 6e-5, F_range=(0.5, 90.0))
    wide = law.with_spread(JOINT)
    wide.to_json(tmp_path / "law.json")
    assert CompressionLaw.from_json(tmp_path / "law.json") == wide
    middle = wide.sample((0.5, 0.5))
    assert (middle.a, middle.b) == pytest.approx((law.a, law.b))
    rng = np.random.default_rng(4)
    drawn = [wide.sample(u) for u in rng.random((4000, 2))]
    logs = np.log([[one.a / law.a, one.b / law.b] for one in drawn])
    within = 1 - 4 * np.exp(-2) / np.sqrt(2 * np.pi) / 0.9545  # of the variance
    assert np.cov(logs.T) == pytest.approx(within * JOINT, rel=0.12)
    assert np.mean([wide.holds(one.a, one.b) for one in drawn]) > 0.95
    assert law.sample((0.9, 0.1)) == law
    assert not law.holds(law.a, law.b)


def test_one_share_moves_the_compression_and_the_other_the_shape():
    """0 is soft, 1 is stiff, by two deviations of the range; across it the compression stays."""
    law = CompressionLaw(4e-5, 6e-5, F_range=(0.5, 90.0)).with_spread(JOINT)
    toward = law.slopes_of_compression()

    def moved(*u):
        drawn = law.sample(u)
        return toward @ np.log([drawn.a / law.a, drawn.b / law.b])

    deviation = np.sqrt(toward @ JOINT @ toward)
    for shape in (0.1, 0.5, 0.8):
        for share, sign in ((0.0, 2), (0.5, 0), (1.0, -2)):
            assert moved(share, shape) == pytest.approx(sign * deviation, abs=1e-12)
    assert law.sample((0.5, 0.9)) != law.sample((0.5, 0.5))


@pytest.mark.parametrize("factor", [1e-3, 0.1, 1.0, 30.0])
def test_slopes_of_compression_are_differences_and_ends_bracket(factor):
    """At low and at high forces, against those of the law itself; a and b that grow alike let all grow alike."""
    law = CompressionLaw(4e-5, 6e-5)
    law = replace(law, F_range=(factor * law.F0, 1.01 * factor * law.F0))
    toward = law.slopes_of_compression()
    F = np.linspace(*law.F_range, 102)[1:]
    step = 1e-5
    of_a = np.log(replace(law, a=law.a * (1 + step)).d(F) / law.d(F)) / step
    of_b = np.log(replace(law, b=law.b * (1 + step)).d(F) / law.d(F)) / step
    assert toward == pytest.approx([np.mean(of_a), np.mean(of_b)], rel=1e-3, abs=1e-6)
    assert sum(toward) == pytest.approx(1)
    wide = law.with_spread([[0.04, -0.02], [-0.02, 0.09]])
    soft, stiff = wide.ends().values()
    forces = np.geomspace(1e-6, 1e6, 60) * law.F0
    assert np.all(soft.d(forces) > law.d(forces))
    assert np.all(stiff.d(forces) < law.d(forces))
