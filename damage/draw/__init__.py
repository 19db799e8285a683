"""Pictures of histories, walls, modes and motions."""
