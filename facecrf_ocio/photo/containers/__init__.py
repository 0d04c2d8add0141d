"""Files as bytes: their kinds, what they consist of, and what no decoder may see."""
