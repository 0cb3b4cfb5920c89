"""Unit cells of TexGen (.tg3): read as a plain weave, and held against our crossover.

worker      reads a file with pytexgen, in a process of its own
geometry    what is read, as a plain weave of two families
comparison  section and path of TexGen's yarns less ours
"""
