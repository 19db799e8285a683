"""What drives a wall: ground-motion records, their intensity, loadings."""
