"""One shot at a fabric of the catalogue, and a sweep of strike velocities. Run with: python examples/first_shot.py"""

import weavecell as wc

fabric = wc.fabric("S-720")
shot = wc.shoot(fabric, "92.5 m/s", opening="100 mm", projectile={"mass": "3 g", "diameter": "5.5 mm"})
print(shot)
shot.plot().savefig("first-shot.svg")
shot.to_vtk("first-shot")

shots = wc.sweep([wc.setup(fabric, velocity, opening="100 mm") for velocity in (80.0, 120.0, 160.0)])
for one in shots:
    print(f"{one.strike_velocity:g} m/s: {one.outcome}, residual velocity {one.residual_velocity:.1f} m/s")
