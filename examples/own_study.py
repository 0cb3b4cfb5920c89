"""
A study of one's own
====================

Does a blunter nose pass less often? Eight drawn panels each are struck at one velocity by a sphere and by a flat
cylinder of the same mass. Place, frictions and strengths of the yarns are drawn, the same for both noses. The table has
a row a shot. It prints how many pass and draws what velocity each panel left. About 8 s.
Run with ``python examples/own_study.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

noses = {
    "sphere": {"shape": "sphere"},
    "flat": {"shape": "flat", "edge_radius": "0.3 mm"},
}
table = wc.RunTable(())
for name, nose in noses.items():
    table += wc.draw(
        "S-728",
        8,
        velocity="95 m/s",
        opening="40 mm",
        projectile={"mass": "0.69 g", "diameter": "5.5 mm"} | nose,
        labels={"nose": name},
    )
shots = wc.run(table).shots
passed = shots["outcome"].eq("perforated").groupby(shots["nose"]).sum()
print(f"of 8 shots pass: sphere {passed['sphere']}, flat {passed['flat']}")
print(shots.groupby("nose")["residual_velocity_m_s"].median().round(1).to_string())

figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
for name, rows in shots.groupby("nose"):
    left = rows["residual_velocity_m_s"].to_numpy()
    axes.plot(range(1, len(left) + 1), left, "o", label=name)
axes.set(xlabel="number of the draw", ylabel="residual velocity [m/s]")
axes.legend()
figure.savefig("own-study.png", dpi=150)
