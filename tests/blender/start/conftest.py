"""The files that these tests write are made in this folder."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
