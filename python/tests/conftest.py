"""Files that most tests need, loaded once."""

import pytest
from support import MODEL, MOTION

import gaitway


@pytest.fixture(scope="session")
def model() -> gaitway.Model:
    """A character with a mesh."""
    return gaitway.load_model(MODEL)


@pytest.fixture(scope="session")
def motion() -> gaitway.Motion:
    """A motion of another skeleton."""
    return gaitway.load_motion(MOTION)
