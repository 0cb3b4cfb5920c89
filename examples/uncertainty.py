"""
How sure is a residual velocity?
================================

One ply of S-720 against the 1.10 g fragment simulator at 170 m/s: on three meshes with equal yarns, and on 30 panels
whose yarns differ in strength (Weibull, scatter assumed). It prints and draws both. The error of the laws and of the
model adds to these (``weavecell impact FILE --uncertainty``, and Validation). About 15 s.
Run with ``python examples/uncertainty.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

setups = {
    f"{n} x {n} elements per crossover": wc.setup(
        "S-720", "170 m/s", opening="80 mm", projectile="FSP 1.10 g", elements_per_crossover=n
    )
    for n in (1, 2, 3)
}
shots = wc.sweep(setups.values())
panels = wc.sweep(
    wc.setup(
        "S-720",
        "170 m/s",
        opening="80 mm",
        projectile="FSP 1.10 g",
        elements_per_crossover=1,
        strength={"weibull_shape": 14.3, "seed": seed},
    )
    for seed in range(30)
)
residuals = panels.to_dataframe()["residual_velocity_m_s"]
print(f"30 panels: {residuals.mean():.1f} m/s, standard deviation {residuals.std():.1f} m/s")

figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
axes.hist(residuals, bins=10, color="0.8", label="30 panels, 1 x 1")
for colour, (name, shot) in enumerate(zip(setups, shots)):
    print(f"{name}: {shot.residual_velocity:.1f} m/s, checks {shot.checks_text}")
    axes.axvline(shot.residual_velocity, color=f"C{colour}", label=f"equal yarns, {name}")
axes.set(xlabel="residual velocity [m/s]", ylabel="panels")
figure.legend(loc="outside lower center", ncols=2)
figure.savefig("uncertainty.png", dpi=150)
