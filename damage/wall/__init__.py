"""The plane wall: its parameters, layout, geometry and contact points."""
