"""Power series between events."""
