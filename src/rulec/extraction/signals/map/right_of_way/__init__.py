"""Who is in whose way where two ways meet, and for what else it slows down."""
