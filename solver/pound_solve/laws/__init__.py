"""Force laws: hysteresis rules and contact laws on one automaton."""
