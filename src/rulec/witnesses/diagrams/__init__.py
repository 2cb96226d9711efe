"""Decision diagrams of joint reads, and plainest ways through them."""
