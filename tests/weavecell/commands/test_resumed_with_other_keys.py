"""A folder to resume from that is of another input file is refused with the keys that differ."""

from tests.scene_text import impact_scene


def test_a_folder_of_another_input_file_names_the_keys(succeed, command, tmp_path):
    scene = impact_scene(opening="20 mm", end_time="3 us")
    (tmp_path / "s.toml").write_text(scene)
    succeed("impact s.toml --out r")
    (tmp_path / "s.toml").write_text(scene.replace("20 mm", "24 mm").replace("155 m/s", "150 m/s"))
    code, _, err = command("impact", "s.toml", "--out", "r", "--resume")
    assert code == 2
    said = err.splitlines()[-1]
    assert "projectile.strike_velocity 155 m/s, now 150 m/s; panel.opening 20 mm, now 24 mm" in said
