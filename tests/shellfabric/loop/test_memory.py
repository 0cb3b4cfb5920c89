"""Memory that a run needs: the estimate against what a process takes, and the refusal before anything is taken."""

import json
import re

import pytest

import weavecell as wc
from shellfabric.loop import memory, pack_memory
from tests.programs import printed

MEASURE = """
import json, sys
import weavecell as wc
from shellfabric.impact.run import run_impact
from shellfabric.loop import pack_memory as memory

def peak():
    return 1024 * next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))

given = json.loads(sys.argv[1])
run = lambda opening: run_impact(wc.setup("S-720", 92.5, opening=opening, symmetry="whole", **given))
run("30 mm")
before = peak()
done = run("300 mm")
print((peak() - before) / memory.needed(done.target.plies, len(done.snapshots)))
"""


@pytest.mark.parametrize(
    "given, low, high",
    [
        pytest.param(
            {"elements_per_crossover": 2, "end_time": "2 us"}, 0.9, 1.1, marks=pytest.mark.slow(3)
        ),
        ({"elements_per_crossover": 2, "end_time": "8 us", "snapshot_interval": "2 us"}, 0.8, 1.1),
        # 640 bytes are the most of packs, 96 of them where plies touch
        (
            {"plies": 2, "elements_per_crossover": 1, "end_time": "2 us"},
            0.55,
            1.1,
        ),
    ],
)
def test_the_estimate_is_what_a_run_takes(given, low, high):
    assert low < float(printed(MEASURE, json.dumps(given))) < high


def test_an_own_limit_of_addresses_counts():
    code = "import resource; resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9)); "
    code += "from shellfabric.loop import memory; print(memory.free())"
    assert 0 < float(printed(code)) < 1e9
    assert memory.free() > 1e6


@pytest.mark.parametrize(
    "call, given, key, content",
    [
        (wc.impact, {}, "opening", "5,929 elements"),
        (wc.impact, {"plies": 3, "elements_per_crossover": 1}, "opening", "18,723 elements"),
        (
            wc.impact,
            {"backing": {"modulus": "100 MPa", "min_size": "2 mm"}},
            "opening",
            "5,929 elements with a block of ",
        ),
        (wc.critical_velocity, {}, "opening", "5,929 elements"),
        (wc.coupon, {"length": 0.1, "width": 0.05, "elongation": 0.005}, "length", "a grid of "),
    ],
)
def test_a_run_above_the_free_memory_is_refused(monkeypatch, call, given, key, content):
    monkeypatch.setattr(memory, "free", lambda: 1e5)
    with pytest.raises(wc.InputError) as problem:
        call("S-720", *{wc.impact: [92.5], wc.coupon: ["bias_extension"]}.get(call, []), **given)
    text = rf"{key} = .* must be smaller, or the elements larger: {content}.*GB of memory, and 0\.0 GB are free"
    assert re.fullmatch(text, str(problem.value))


def test_snapshots_are_named_where_they_take_the_larger_part(monkeypatch):
    monkeypatch.setattr(memory, "free", lambda: 1e5)
    text = "snapshot_interval: must be longer: 5,929 elements with 8 snapshots need about"
    with pytest.raises(wc.InputError, match=text):
        wc.impact("S-720", 92.5, snapshot_interval="100 us")


def test_each_ply_of_a_pack_counts_its_resolved_yarns():
    pinned, resolved = (
        wc.setup("S-726", "100 m/s", opening="40 mm", plies=3, crossovers=how).target().plies
        for how in ("pinned", "yarns")
    )
    alone = [
        sum(pack_memory.needed([ply]) - pack_memory.ELEMENT * ply.elements for ply in plies)
        for plies in (pinned, resolved)
    ]
    packs = [
        pack_memory.needed(plies) - pack_memory.PACK * sum(ply.elements for ply in plies)
        for plies in (pinned, resolved)
    ]
    assert packs == pytest.approx(alone)
    assert packs[0] == 0 < packs[1]
