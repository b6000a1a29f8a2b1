"""Makes `proof` importable by name, also in the processes that its tests start."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
