"""The virtual mock-up: a simulated bench whose outcome is a record, and the models that are compared with it.

The authors' data are not public. What is called a virtual measurement here comes from `mockup.toml`, a model
richer than `model.toml`, and from sensors with noise, rate and delay.
"""

from flexarm.mockup.experiment import Experiment, virtual_measurement
from flexarm.mockup.models import PARAMETER_SETS, mock_up, model

__all__ = ["PARAMETER_SETS", "Experiment", "mock_up", "model", "virtual_measurement"]
