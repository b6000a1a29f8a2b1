"""Where the real recordings lie: beside the repository, or where THENAR_RECORDINGS says."""

import os
from pathlib import Path

import pytest

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "recordings"


@pytest.fixture(scope="session")
def shared():
    folder = Path(os.environ.get("THENAR_RECORDINGS", BESIDE))
    if not folder.is_dir():
        pytest.skip(f"no recordings in {folder}; set THENAR_RECORDINGS to run this")
    return folder
