"""Results as one HTML file that can be sent: it needs a browser and nothing else, no network
either."""
