"""Campaigns: one study, many runs of a model whose parameters vary, kept in one file of results.

A study says what varies and how it is sampled (`study`, `sampling`), the engine spreads its runs over cores
(`engine`), and the store keeps each batch as it comes, so that a run goes on where it was stopped (`store`).
"""
