"""What the numbers of the 3D crossover depend on: mesh, penalty, load step, end condition, section, tips, bars, moduli.

Each choice is varied alone about the defaults. Where a choice has a limit (element size, 1 / penalty, ...) the values
are extrapolated to it, with the order observed; every case is timed, and the choices of the method are set beside each
other as time against error. Nothing is compared with a measurement.
"""
