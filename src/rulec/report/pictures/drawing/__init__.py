"""TODO report/pictures/drawing."""
