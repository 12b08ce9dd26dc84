"""Which effects the data speak for: screened, fitted, weighed against rivals, tested on what was left out."""
