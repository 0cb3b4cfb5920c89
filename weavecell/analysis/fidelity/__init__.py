"""Fidelity on demand: the cheapest model that meets the targets of a scene.

models      the ladder of models, what each changes in a set-up, and what it costs
quantities  the quantities that can have a target, how it is read from a run, and how two answers are compared
book        the errors that each model is known to make (errors.json), which the survey has computed
choose      choice, run, check by a coarser mesh, and refinement until the promise holds
survey      the runs behind errors.json
trial       random scenes that the survey has not seen
"""
