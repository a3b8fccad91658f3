"""What notebooks display. tests/browser/notebook.test.mjs executes one and opens it."""

import html
import re
from pathlib import Path

import pytest
from support import MOTION

import gaitway

TEMPLATE = '<head><!-- scene --></head><body><p title="it\'s & more"></p><!-- files --></body>'


@pytest.fixture
def page(tmp_path: Path) -> Path:
    """A folder with a template without a program."""
    folder = tmp_path / "page"
    folder.mkdir()
    for backend in ("webgl2", "webgpu"):
        (folder / f"standalone-{backend}-0123456789abcdef.html").write_text(TEMPLATE + backend)
    return folder


def test_a_scene_is_a_sandboxed_frame(model: gaitway.Model, motion: gaitway.Motion, page: Path) -> None:
    scene = gaitway.show(model, motion, clip=0, title="A 'walk'", height=300, page=page)
    shown = scene._repr_html_()
    frame = re.fullmatch(
        r"<iframe sandbox='allow-scripts' title='A &#39;walk&#39;' width='100%' height='300' style='border: 0' "
        r"srcdoc='([^']*)'></iframe>",
        shown,
    )
    assert frame is not None, shown[:200]
    assert html.unescape(frame[1]) == scene.html
    assert re.findall('data-name="([^"]*)" data-role="([a-z]*)"', scene.html) == [
        ("mannequin.glb", "model"),
        ("walk.bvh", "motion"),
    ]
    assert "&amp;motion=walk.bvh" in scene.html
    assert scene.html.endswith("webgl2")


def test_a_large_scene_names_the_choices(model: gaitway.Model, page: Path) -> None:
    for backend in ("webgl2", "webgpu"):
        large = page / f"standalone-{backend}-0123456789abcdef.html"
        large.write_text(TEMPLATE + "x" * 2_900_000)
    with pytest.raises(gaitway.Error, match=r"at most 2\.9 MB.*renderer=\"webgpu\".*textures.*file=\"scene\.html\""):
        gaitway.show(model, page=page)
    with pytest.raises(gaitway.Error, match=r"MB; make the model's textures"):
        gaitway.show(model, renderer="webgpu", page=page)


def test_a_file_beside_the_notebook(
    model: gaitway.Model, page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = gaitway.show(model, file="scene.html", page=page)
    assert (tmp_path / "scene.html").read_text() == scene.html
    assert " src='scene.html'" in scene._repr_html_()
    scene.write("other.html")
    assert (tmp_path / "other.html").read_text() == scene.html


def test_what_is_wrong_is_said(model: gaitway.Model, tmp_path: Path) -> None:
    with pytest.raises(gaitway.Error, match="there is no standalone-webgl2"):
        gaitway.show(model, page=tmp_path)
    with pytest.raises(gaitway.Error, match="expected webgl2 or webgpu, found gl"):
        gaitway.show(model, renderer="gl", page=tmp_path)


def test_files_that_were_read_are_kept(page: Path, tmp_path: Path) -> None:
    copy = tmp_path / "walk.bvh"
    copy.write_bytes(MOTION.read_bytes())
    with pytest.raises(gaitway.Error, match="one of the files that were read"):
        gaitway.show(gaitway.load_model(copy), file=copy, page=page)
