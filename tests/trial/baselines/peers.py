"""Peers that answer the same studies in the same schema, each with the rows of the table that it can be scored on."""

from trial.baselines.bic import Bic
from trial.baselines.classifier import Classifier
from trial.baselines.process import Process

BASELINES = {"bic": Bic, "gp": Process, "classifier": Classifier}
