"""The bench: how well each estimator does on photos whose response is known."""
