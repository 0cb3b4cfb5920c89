"""The projectile as a body of revolution of elastic-plastic metal: elements, own steps, its part in
a run."""
