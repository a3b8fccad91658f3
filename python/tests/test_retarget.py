"""Maps, retargeted clips and written files are those of the command line."""

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from support import MODEL, MOTION, SAMPLES, cli, text_of_cli

import gaitway

PAIR = ("--model", MODEL, "--motion", MOTION)
OPTIONS = {
    "as proposed": ({}, []),
    "clip": ({"clip": 0}, ["--clip", "0"]),
    "planted": ({"feet": "plant", "horizontal": "in-place"}, ["--feet", "plant", "--horizontal", "in-place"]),
    "changed": (
        {"mirror": True, "reverse": False, "trim": (0.1, 0.5), "offset": (-1, 0.5), "turn": -90, "speed": None},
        ["--mirror", "--trim", "0.1,0.5", "--offset", "-1,0.5", "--turn", "-90"],
    ),
    "kept contacts": ({"contacts": "keep", "origin": "rest"}, ["--contacts", "keep", "--origin", "rest"]),
    "looped and pinned": (
        {"make_loop": 0.2, "speed": 1.5, "pin": ["leftHand=at:0.3,1.2,0.4@0.2,0.5,0.1", "head=look:0,1.5,3"]},
        [
            *("--make-loop", "0.2", "--speed", "1.5"),
            *("--pin", "leftHand=at:0.3,1.2,0.4@0.2,0.5,0.1", "--pin", "head=look:0,1.5,3"),
        ],
    ),
}


def test_the_proposed_map(model: gaitway.Model, motion: gaitway.Motion) -> None:
    assert gaitway.propose_map(model, motion) == cli("map", *PAIR)


@pytest.mark.parametrize(("options", "arguments"), OPTIONS.values(), ids=OPTIONS.keys())
def test_figures_and_files(
    model: gaitway.Model, motion: gaitway.Motion, tmp_path: Path, options: dict, arguments: list
) -> None:
    result = gaitway.retarget(model, motion, **options)
    for extension in ("glb", "bvh", "vrma"):
        ours, theirs = tmp_path / f"ours.{extension}", tmp_path / f"theirs.{extension}"
        report = cli("retarget", *PAIR, *arguments, "--clip-only", "--out", theirs)
        result.clip.write(ours)
        assert ours.read_bytes() == theirs.read_bytes()
    assert result.report == report
    assert result.figures == report["figures"]
    assert result.figures["coverage"] > 0.5
    assert result.clip.name == report["clip"]
    assert result.clip.duration_secs == pytest.approx(report["duration_secs"])


def test_options_that_repeat(motion: gaitway.Motion, tmp_path: Path) -> None:
    pilot, layers = SAMPLES / "pilot.glb", ["wave:weight:0.5", "idle:additive"]
    arguments = ["retarget", "--model", pilot, "--motion", MOTION, "--layer", layers[0], "--layer", layers[1]]
    report = cli(*arguments, "--clip-only", "--out", tmp_path / "theirs.glb")
    result = gaitway.retarget(gaitway.load_model(pilot), motion, layer=layers)
    result.clip.write(tmp_path / "ours.glb")
    assert result.report == report
    assert (tmp_path / "ours.glb").read_bytes() == (tmp_path / "theirs.glb").read_bytes()


def test_models_with_clips(model: gaitway.Model, motion: gaitway.Motion, tmp_path: Path) -> None:
    clip = gaitway.retarget(model, motion).clip
    ours, theirs = tmp_path / "ours.glb", tmp_path / "theirs.glb"
    model.write(ours, [clip])
    text_of_cli("retarget", *PAIR, "--out", theirs)
    assert ours.read_bytes() == theirs.read_bytes()
    both = tmp_path / "both.glb"
    model.write(both, [clip, gaitway.retarget(model, motion, mirror=True).clip])
    assert len(gaitway.load_model(both).clips) == len(model.clips) + 2


def test_maps(model: gaitway.Model, motion: gaitway.Motion, tmp_path: Path) -> None:
    proposed = gaitway.propose_map(model, motion)
    joint, entry = next((joint, entry) for joint, entry in proposed["joints"].items() if entry.get("slot") == "head")
    entry["source"] = None
    proposed["feet"] = "plant"
    result = gaitway.retarget(model, motion, proposed)
    assert joint in result.report["unmapped_targets"]
    assert result.report["planting"] is not None
    path = tmp_path / "map.json"
    path.write_text(json.dumps(proposed))
    assert gaitway.retarget(model, motion, path).report == result.report
    assert gaitway.retarget(model, motion, str(path), feet="off").report["planting"] is None
    assert cli("retarget", *PAIR, "--map", path, "--out", tmp_path / "out.glb") == result.report


def test_errors(model: gaitway.Model, motion: gaitway.Motion, tmp_path: Path) -> None:
    with pytest.raises(gaitway.Error, match=r"invalid value 'no' for '--feet <FEET>' \[possible values: off, plant\]"):
        gaitway.retarget(model, motion, feet="no")
    with pytest.raises(gaitway.Error, match="unexpected argument '--out'"):
        gaitway.retarget(model, motion, out="new.glb")
    with pytest.raises(gaitway.Error) as raised:
        gaitway.retarget(model, motion, {"gaitway_map": 1, "joints": {"nobody": {"source": "hip"}}})
    assert raised.value.file == "map"
    assert "nobody" in str(raised.value)
    with pytest.raises(gaitway.Error, match=r"expected \.glb or \.bvh or \.vrma, found \.fbx"):
        motion.clips[0].write(tmp_path / "new.fbx")
    with pytest.raises(gaitway.Error, match="is for other joints"):
        model.write(tmp_path / "new.glb", motion.clips)
    with pytest.raises(TypeError):
        gaitway.retarget(motion, model)
    assert not list(tmp_path.iterdir())


def test_threads_share_files(model: gaitway.Model, motion: gaitway.Motion) -> None:
    speeds = [0.5, 1, 2, 4]
    alone = [gaitway.retarget(model, motion, speed=speed).report for speed in speeds]
    with ThreadPoolExecutor(2) as pool:
        together = pool.map(lambda speed: gaitway.retarget(model, motion, speed=speed).report, speeds)
    assert list(together) == alone
