"""Exports with many clips are those of the command line."""

from pathlib import Path

import pytest
from support import MOTION, SAMPLES, cli, text_of_cli

import gaitway

PILOT = SAMPLES / "pilot.glb"


def test_one_file(motion: gaitway.Motion, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.glb", tmp_path / "theirs.glb"
    options = {"clips": ["idle", "walk (2)"], "rename": {"walk (2)": "March"}, "for_": "godot", "root_bone": True}
    document = gaitway.load_model(PILOT).export(ours, [motion], **options)
    arguments = ("--clips", "idle,walk (2)", "--rename", "walk (2)=March", "--for", "godot", "--root-bone")
    assert document == cli("export", PILOT, "--motion", MOTION, *arguments, "--out", theirs)
    assert ours.read_bytes() == theirs.read_bytes()
    assert [clip.name for clip in gaitway.load_model(ours).clips] == ["idle", "March"]


def test_fbx(motion: gaitway.Motion, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.fbx", tmp_path / "theirs.fbx"
    document = gaitway.load_model(PILOT).export(ours, [motion], for_="unity")
    assert [file["bytes"] for file in document["files"]] == [ours.stat().st_size]
    text_of_cli("export", PILOT, "--motion", MOTION, "--for", "unity", "--out", theirs)
    assert ours.read_bytes() == theirs.read_bytes()
    assert len(gaitway.load_model(ours).clips) == len(document["clips"])


def test_fewer_keys(tmp_path: Path) -> None:
    model, sizes = gaitway.load_model("sample:walker"), {}
    for name, fewer_keys in [("all", False), ("default", True), ("loose", (1.0, 1.0))]:
        model.export(tmp_path / f"{name}.glb", fewer_keys=fewer_keys)
        sizes[name] = (tmp_path / f"{name}.glb").stat().st_size
    assert sizes["all"] > sizes["default"] > sizes["loose"]


def test_a_file_for_each_clip(tmp_path: Path) -> None:
    model = gaitway.load_model(PILOT)
    model.export(tmp_path / "ours", format="bvh")
    text_of_cli("export", PILOT, "--format", "bvh", "--out", tmp_path / "theirs")
    names = sorted(path.name for path in (tmp_path / "theirs").iterdir())
    assert names == sorted(f"{clip.name}.bvh" for clip in model.clips)
    for name in names:
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes()


def test_bad_plans_are_refused(tmp_path: Path) -> None:
    model = gaitway.load_model(PILOT)
    for options, says in [
        ({"clips": "fly"}, "“fly”"),
        ({"rename": {"idle": "run"}}, "would both be called"),
        ({"for_": "unreal"}, "FBX"),
        ({"speed": 2}, "--speed"),
    ]:
        with pytest.raises(gaitway.Error, match=says):
            model.export(tmp_path / "out.glb", **options)
    assert not list(tmp_path.iterdir())
