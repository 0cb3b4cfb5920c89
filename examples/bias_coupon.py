"""
Shear of a fabric in two coupons
================================

A picture frame shears the fabric evenly, and its shear stress is that of the trellis law. A strip cut at 45 degrees
(bias extension) has zones of different shear. Run with ``python examples/bias_coupon.py``.
"""

import weavecell as wc

frame = wc.coupon("S-728", "picture_frame", shear_angle="20 deg", steps=20)
print(frame.summary()["shear_stress_Pa"] / 1e6, "MPa at 20 degrees")
figure = frame.plot()

# %%
# A bias coupon of 72 by 36 mm between the clamps: angle between the yarns in its three zones.

bias = wc.coupon("S-728", "bias_extension", length="72 mm", width="36 mm", elongation="3 mm", steps=6)
print(bias.outcome)
bias_figure = bias.plot()
