"""
Shear of a fabric in a picture frame
====================================

A picture frame shears S-728 to 30 degrees; shear stiffness grows where parallel yarns touch. It prints the shear stress
and draws it against the shear angle. ``wc.coupon`` also makes bias extension, uniaxial, biaxial and pull-out tests.
About 5 s. Run with ``python examples/coupon.py``.
"""

import weavecell as wc

frame = wc.coupon("S-728", "picture_frame", shear_angle="30 deg", steps=20)
print(frame.outcome)
print(f"shear stress {frame.summary()['shear_stress_Pa'] / 1e6:.2f} MPa at 30 degrees")

figure = frame.plot()
figure.savefig("coupon.png", dpi=150)
