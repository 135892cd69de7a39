"""Reports, plots and tables from a results file and from the catalog."""
