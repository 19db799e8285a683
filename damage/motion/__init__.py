"""Input of a run: ground-motion records, their intensity, loadings."""
