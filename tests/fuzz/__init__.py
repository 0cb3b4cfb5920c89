"""Random fabrics and scenes: `python -m tests.fuzz` (`make fuzz`) runs thousands, `test_fuzz.py` a few.

`scenes` samples the space of inputs, `runs` runs one scene and says how it ended, `pool` runs many in processes of
their own, `table` writes and summarises the outcomes. A scene is named by (seed, index), and written by
`python -m tests.fuzz --seed SEED --show INDEX` as files for `weavecell impact`.
"""
