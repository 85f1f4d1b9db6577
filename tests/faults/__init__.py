"""What the project does when the machine, its files or its callers fail."""
