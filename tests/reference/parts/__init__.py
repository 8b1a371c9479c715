"""Parts against the whole, and against parts that know nothing of each other."""
