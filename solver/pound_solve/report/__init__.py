"""What is made of a results file and of the catalog."""
