"""Missing laws: latent motions that an unexplained gap asks for, and what they are functions of."""
