"""Closed loops: sampled controllers and motors that move an arm along a command.

The laws stand in the model, `flexarm.arm.controller` and `flexarm.arm.motor`; here they run beside the finite
elements. `flexarm.simulate` comes here when a drive is a command.
"""

from flexarm.control.closed_loop import Schedule, simulate_closed_loop

__all__ = ["Schedule", "simulate_closed_loop"]
