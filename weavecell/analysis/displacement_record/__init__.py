"""Reduction of a measured displacement record to velocity, deceleration, energy and force (thesis section 2.3).

The thesis's laser system records the displacement of the projectile; all else follows by differentiation, which turns
noise into error. Here every derived history carries its error: that of the noise, and that of the smoothing itself.
"""
