"""Many cases from a job file, here or on a cluster: one row each, resumable; no bad case stops the rest."""

from .conductor import By, run
from .jobs import read_jobs

__all__ = ["By", "read_jobs", "run"]
