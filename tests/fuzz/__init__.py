"""Random fabrics and scenes: `python -m tests.fuzz` (`make fuzz`) runs thousands, `test_fuzz.py` a few.

`scenes` samples the space of inputs, `runs` runs one scene and says how it ended. A scene is named by (seed, index);
`python -m tests.fuzz --seed SEED --show INDEX` writes it as files for `weavecell impact`.
"""
