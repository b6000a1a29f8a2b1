"""Peers that answer the same studies in the same schema, each with the rows of the table that it can be scored on."""

from trial.baselines.bic import Bic

BASELINES = {"bic": Bic}
