"""Lives of walls: the study that makes them, their results, probabilities of visible damage."""
