"""What is printed of a torn shot: numbers that its mirror images have too."""

import pytest

import weavecell as wc

COST = "wall_time_s", "element_step_time_ns"


def summary(*aim):
    """The numbers of a torn shot at an aim [mm] from the middle of a yarn of both families."""
    shot = wc.impact(
        "S-728",
        "190 m/s",
        opening="40 mm",
        projectile="sphere 5.5 mm",
        crossovers="pinned",
        symmetry="whole",
        impact_point=[f"{x} mm" for x in aim],
    )
    found = shot.summary()
    return {name: value for name, value in found.items() if name not in COST}


def test_mirror_images_of_a_torn_shot_have_the_same_numbers():
    """Rounding parts them, which torn ends blow up: by 5 % in the largest deflection, which is none."""
    own, image = summary(0.43, 0.29), summary(-0.43, 0.29)
    assert own["outcome"] == "perforated"
    assert own["cut_yarns"] > 1
    assert own["max_deflection_m"] is None
    numbers = {name: value for name, value in own.items() if type(value) is float}
    assert len(numbers) > 15
    for name, value in numbers.items():
        assert image[name] == pytest.approx(value, rel=1e-6), name
