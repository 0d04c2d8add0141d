"""The paper's method and its rivals, each an estimator of its own behind one registry."""
