"""Fidelity on demand: the cheapest model that answers what a scene asks, as well as it asks.

models      the ladder of models, what each changes in a set-up, and what it costs
quantities  what can be asked for, how it is read from a run, and how two answers are compared
book        the errors that each model is known to make (errors.json), which the survey has measured
choose      choice, run, check by a coarser mesh, and refinement until the promise holds
survey      the runs behind errors.json
trial       random scenes that the survey has not seen
"""
