"""
Export of a deck
================

Two plies of S-728 as a deck of LS-DYNA in the folder ``deck``: mesh, ``*MAT_FABRIC``, clamps, rigid projectile and
contact. It prints and draws the error of the material card against the unit cell: rms and largest over the biaxial
plane, in uniaxial tension and in shear. LS-DYNA was not run with it. About 5 s.
Run with ``python examples/export_deck.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

pack = wc.setup("S-728", "150 m/s", plies=2, opening="100 mm", projectile="FSP 1.10 g")
errors = {"LS-DYNA *MAT_FABRIC": wc.export(pack, "lsdyna", "deck").summary()}
errors["OpenRadioss /MAT/LAW58"] = wc.export(pack, "radioss", "deck-radioss").summary()

figure, axes = plt.subplots(figsize=(7.2, 3.6), layout="constrained")
for row, (code, found) in enumerate(errors.items()):
    print(code, {name: f"{100 * error:.1f} %" for name, error in found.items()})
    axes.barh(
        [at + 0.4 * row for at in range(len(found))],
        [100 * error for error in found.values()],
        0.35,
        label=code,
    )
axes.set_yticks([at + 0.2 for at in range(len(found))], list(found))
axes.set(xlabel="error of the material card [% of the strength of a yarn]")
axes.legend()
figure.savefig("export-deck.png", dpi=150)
