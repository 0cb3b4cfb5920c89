"""Cost against error: standard cases, each solved by every method of the project.

One file a scene. `core` times methods and holds them against the scene's own converged reference; `shots` runs impacts
on one ply; `tables`, `page` and `pictures` tell what came out. measured/ holds the tables of the last full run, from
which a method can be chosen by what it costs and how wrong it is.
"""
