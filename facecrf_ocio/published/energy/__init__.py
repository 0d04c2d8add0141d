"""The terms of the objective (sec. 4), each with its gradient."""
