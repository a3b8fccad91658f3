"""Loading: the same files and the same messages as on the command line."""

from pathlib import Path

import numpy as np
import pytest
from support import MODEL, MOTION, SAMPLES, cli

import gaitway


@pytest.mark.parametrize("name", ["mannequin.glb", "pilot.glb", "walk.bvh", "ssd.obj"])
def test_models_contain_what_the_command_line_lists(name: str) -> None:
    model = gaitway.load_model(SAMPLES / name)
    assert model.name == name
    assert model.inspect() == cli("inspect", SAMPLES / name)
    assert len(model.joints) == len(model.parents) == model.inspect()["nodes"]
    assert [clip.name for clip in model.clips] == [clip["name"] for clip in model.inspect()["clips"]]


def test_samples_and_several_files() -> None:
    assert gaitway.load_model("sample:walker").inspect() == cli("inspect", "sample:walker")
    parts = [SAMPLES / name for name in ("ssd.obj", "ssd.skel", "ssd.attach")]
    assert gaitway.load_model(*parts).inspect() == cli("inspect", *parts)


def test_motions(motion: gaitway.Motion) -> None:
    assert repr(motion) == f"<gaitway.Motion walk.bvh, {len(motion.joints)} joints, 1 clips>"
    assert motion.parents[0] == -1
    assert (motion.parents < np.arange(len(motion.joints))).all()
    assert sorted(motion.nodes) == list(range(len(motion.joints)))


def test_numpy_archives_that_numpy_writes(tmp_path: Path) -> None:
    path = tmp_path / "smpl.npz"
    frames = 20
    poses = np.zeros((frames, 22, 3))
    poses[:, 16, 2] = np.linspace(0, 1, frames)
    np.savez(path, poses=poses.reshape(frames, -1), trans=np.zeros((frames, 3)), mocap_framerate=25.0)
    motion = gaitway.load_motion(path)
    assert motion.inspect()["clips"] == cli("inspect", path)["clips"]
    [clip] = motion.clips
    assert clip.frames_per_sec == 25
    assert clip.duration_secs == pytest.approx(0.76)
    assert clip.key_times == pytest.approx(np.arange(frames) / 25)
    np.savez(path, poses=np.array([{"joint": 1}], dtype=object), mocap_framerate=25.0)
    with pytest.raises(gaitway.Error, match=r"smpl\.npz: .*pickled Python objects.*numpy\.savez"):
        gaitway.load_motion(path)


def broken(folder: Path) -> Path:
    path = folder / "broken.bvh"
    path.write_text(MOTION.read_text().replace("CHANNELS 3", "CHANNELS three", 1))
    return path


@pytest.mark.parametrize("make", [broken, lambda folder: folder / "missing.glb", lambda folder: folder])
def test_errors_are_those_of_the_command_line(tmp_path: Path, make) -> None:
    path = make(tmp_path)
    with pytest.raises(gaitway.Error) as raised:
        gaitway.load_model(path)
    expected = cli("inspect", path, status=1)["error"]
    parts = ["file", "where", "expected", "found", "hint"]
    found = {part: getattr(raised.value, part) for part in parts if getattr(raised.value, part) is not None}
    assert found | {"message": str(raised.value)} == expected


def test_errors_about_motions_and_arguments(tmp_path: Path) -> None:
    for name in ("a.bvh", "b.bvh"):
        (tmp_path / name).write_bytes(MOTION.read_bytes())
    with pytest.raises(gaitway.Error, match=r"expected one motion, found a\.bvh, b\.bvh"):
        gaitway.load_motion(tmp_path)
    with pytest.raises(gaitway.Error, match="there is nothing to open"):
        gaitway.load_model()
    with pytest.raises(TypeError):
        gaitway.load_model(3)
    assert issubclass(gaitway.Error, ValueError)


def test_files_that_were_read_are_not_overwritten(model: gaitway.Model, motion: gaitway.Motion) -> None:
    before = MODEL.read_bytes(), MOTION.read_bytes()
    with pytest.raises(gaitway.Error, match="one of the files that were read"):
        model.write(MODEL)
    with pytest.raises(gaitway.Error, match="one of the files that were read"):
        motion.clips[0].write(MOTION)
    assert before == (MODEL.read_bytes(), MOTION.read_bytes())
