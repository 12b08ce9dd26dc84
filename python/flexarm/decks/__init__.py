"""Input decks of finite element programs: keywords of Abaqus and CalculiX, cards of Nastran."""
