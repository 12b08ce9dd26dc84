"""Effects at the places where they can sit, and how each is probed."""
