"""Methods that know the motion between events in closed form."""
