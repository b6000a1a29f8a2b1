"""Many cases from a job file, here or on a cluster: one row each, resumable; no bad case stops the rest."""

from .conductor import By, run
from .jobs import read_jobs
from .stopping import Stopped, by_signals

__all__ = ["By", "Stopped", "by_signals", "read_jobs", "run"]
