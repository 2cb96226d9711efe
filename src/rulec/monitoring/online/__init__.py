"""What a monitor is made of: machines that take one state after the other, as they come."""
