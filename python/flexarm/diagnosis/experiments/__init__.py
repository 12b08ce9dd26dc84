"""What to measure: before a campaign (`flexarm.plan`), and next, after a diagnosis."""
