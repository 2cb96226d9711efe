"""The gallery: drives that violate a rule, each as a page that plays it."""
