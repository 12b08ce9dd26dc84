"""Comparison of a model with a record: simulate, align, and show the gap by direction and band."""

from flexarm.comparison.compare import compare
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.frequency_response import ResponseComparison, compare_responses
from flexarm.comparison.gap import SignalGap

__all__ = ["Comparison", "ResponseComparison", "SignalGap", "compare", "compare_responses"]
