"""
Dent in clay behind a pack
==========================

Four plies of S-728 on a block of Roma Plastilina No. 1, struck by the 1.10 g fragment simulator at 150 m/s. It prints
the back-face signature, or how deep the dent has been if the block still moves, and draws its section. The block is
small, 80 x 80 x 40 mm: the held fabric lies on its face, and the run says so. Most data of clay are assumed
(``weavecell show "Roma Plastilina No. 1"``). About 20 s.
Run with ``python examples/clay_backing.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

clay = {
    "material": "Roma Plastilina No. 1",
    "size": ["80 mm", "80 mm", "40 mm"],
    "min_size": "1 mm",
}
shot = wc.impact(
    "S-728",
    "150 m/s",
    plies=4,
    opening="80 mm",
    projectile="FSP 1.10 g",
    backing=clay,
    end_time="400 us",
)
print(f"{shot.outcome}, checks {shot.checks_text}")
signature = shot.summary()["back_face_signature_mm"]
if signature is None:
    # a signature is read of a block at rest; the dent is still growing or springing back
    deepest = shot.summary()["deepest_dent_mm"]
    print(f"the block still moves: its dent has been {deepest:.1f} mm deep")
    print('for the dent at rest give the block a time after the stop, "after_stop": "3 ms"')
    print("(it takes many minutes: the clamped fabric goes on with it)")
else:
    print(f"back-face signature {signature:.1f} mm")

figure, axes = plt.subplots(figsize=(7.2, 3.6), layout="constrained")
block = shot.backing
for family, section in (("along the warp", block.crater), ("along the weft", block.crater_weft)):
    axes.plot(1e3 * section[:, 0], -1e3 * section[:, 1], "o-", label=f"{family}, nodes of the face")
axes.set(xlabel="distance from the impact point [mm]", ylabel="face of the clay [mm]")
axes.legend()
figure.savefig("clay-backing.png", dpi=150)
