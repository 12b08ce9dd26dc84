"""The data before the physics: what a channel, a drive, a clock shows if it is at fault."""
