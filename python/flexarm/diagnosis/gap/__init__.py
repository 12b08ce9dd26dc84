"""Where a gap is and what it follows, and how small it could be: the pictures before any name."""
