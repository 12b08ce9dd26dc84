"""The steps of `flexarm.diagnosis.check`: what a channel, a drive, a clock shows if it is at fault."""
