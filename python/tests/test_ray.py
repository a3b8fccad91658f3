"""The recipe for many machines, on one."""

import shutil
import sys
from pathlib import Path

import pytest
from support import MODEL, MOTION, REPOSITORY

import gaitway

ray = pytest.importorskip("ray", reason="Ray isn't installed (python/requirements-ray.txt)")


def test_a_folder_of_motions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "motions"
    folder.mkdir()
    for name in ("a.bvh", "b.bvh", "c.bvh"):
        shutil.copy(MOTION, folder / name)
    (folder / "bad.bvh").write_text("nonsense")
    examples = REPOSITORY / "python" / "examples"
    monkeypatch.setattr(sys, "path", [str(examples), *sys.path])
    monkeypatch.setenv("PYTHONPATH", str(examples))
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    from ray_folder import retarget_folder  # noqa: PLC0415

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    try:
        rows = retarget_folder(MODEL, folder, tmp_path / "out").take_all()
    finally:
        ray.shutdown()
    rows.sort(key=lambda row: row["motion"])
    assert [Path(row["motion"]).name for row in rows] == ["a.bvh", "b.bvh", "bad.bvh", "c.bvh"]
    assert [row["error"] is None for row in rows] == [True, True, False, True]
    assert "bad.bvh" in rows[2]["error"]
    model, alone = gaitway.load_model(MODEL), tmp_path / "alone.glb"
    for row in rows[:2]:
        result = gaitway.retarget(model, gaitway.load_motion(row["motion"]))
        result.clip.write(alone)
        assert Path(row["out"]).read_bytes() == alone.read_bytes()
        assert row["limb_error_degrees"] == result.figures["limb_direction_error_degrees_mean"]
