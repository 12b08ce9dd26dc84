"""Effects, clocks, frames and uncertain values fitted through the full simulation."""
