"""What people look at: pictures of histories, walls and modes."""
